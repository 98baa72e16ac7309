// A tree over the lights: one is found by going down, at each node to either child in proportion to an upper bound
// of what its lights can send to the surface point (Conty Estevez, Kulla 2018; the bound is that of pbrt-v4,
// LightBounds::Importance, with bounding spheres). The same walk along a light's stored trail gives the probability
// of finding it, for light that a path met by itself.
#ifndef LIGHT_TREE_GLSL
#define LIGHT_TREE_GLSL

// cos and sin of max(0, a − b), from those of a and b.
float cosOfDifference(float sinA, float cosA, float sinB, float cosB) {
    return cosA > cosB ? 1.0 : cosA * cosB + sinA * sinB;
}
float sinOfDifference(float sinA, float cosA, float sinB, float cosB) {
    return cosA > cosB ? 0.0 : sinA * cosB - cosA * sinB;
}
float sinOf(float cosine) { return sqrt(max(0.0, (1.0 - cosine) * (1.0 + cosine))); }

LightTreeChild loadLightTreeChild(uint texel) {
    return unpackLightTreeChild(LOAD(lightTreeTexels, texel), LOAD(lightTreeTexels, texel + 1u),
                                LOAD(lightTreeTexels, texel + 2u));
}

AliasRecord lightAlias(uint index) { return unpackAliasRecord(LOAD(lightAliasTexels, index)); }

// What the lights of a subtree can send to a plane with normal n at p, or to any plane there where n is zero; times a
// factor that is the scene's. Never 0 where light can arrive on the side of n.
float lightTreeImportance(uint texel, vec3 p, vec3 n) {
    LightTreeChild child = loadLightTreeChild(texel);
    float cosO = child.cosThetaO, cosE = child.cosThetaE;
    float sinO = sinOf(cosO);
    bool anyPlane = n == vec3(0);
    if ((child.flags & LIGHT_TREE_INFINITE) != 0u) {
        float cosI = dot(n, child.axis);
        return anyPlane ? child.intensity : child.intensity * max(0.0, cosOfDifference(sinOf(cosI), cosI, sinO, cosO));
    }
    vec3 away = p - child.centre;
    float distance2 = dot(away, away), radius2 = child.radius * child.radius;
    away *= inversesqrt(max(distance2, 1e-37));
    // Half the angle that the lights fill, all around for a point among them.
    bool inside = distance2 <= radius2;
    float sinB = inside ? 0.0 : sqrt(radius2 / distance2), cosB = inside ? -1.0 : sqrt(1.0 - sinB * sinB);
    // From the axis, less the spread of the normals, less that angle: how far beyond a normal the point can be at least.
    float cosW = dot(child.axis, away);
    if ((child.flags & LIGHT_TREE_TWO_SIDED) != 0u) cosW = abs(cosW);
    float sinW = sinOf(cosW);
    float cosX = cosOfDifference(sinW, cosW, sinO, cosO), sinX = sinOfDifference(sinW, cosW, sinO, cosO);
    float cosP = cosOfDifference(sinX, cosX, sinB, cosB);
    if (cosP <= cosE) return 0.0;
    float importance = child.intensity * cosP / max(max(distance2, radius2), 1e-37);
    if (anyPlane) return importance;
    float cosI = -dot(away, n);
    return importance * max(0.0, cosOfDifference(sinOf(cosI), cosI, sinB, cosB));
}

// What decides at a node: one of 2^32 numbers falls below `threshold` for the less likely child.
struct LightTreeFork {
    bool none;         // no light of either child can reach the point
    bool secondIsLess;
    uint threshold;
};

LightTreeFork lightTreeFork(uint node, vec3 p, vec3 n) {
    float first = lightTreeImportance(node, p, n), second = lightTreeImportance(node + LIGHT_TREE_CHILD_TEXELS, p, n);
    LightTreeFork f;
    f.secondIsLess = second < first;
    float less = min(first, second), sum = first + second;
    f.none = !(sum > 0.0);
    float share = f.none ? 0.0 : less / sum;
    if (share > 0.0 && (loadLightTreeChild(node).flags & LIGHT_TREE_BALANCED) != 0u) share = max(share, LIGHT_TREE_LEAST);
    f.threshold = uint(share * 4294967296.0);
    return f;
}

// The probability is the threshold's, so what is sampled and what is asked for agree to the last digit.
float lightTreeChance(LightTreeFork f, bool less) {
    float chance = float(f.threshold) * (1.0 / 4294967296.0);
    return less ? chance : 1.0 - chance;
}

uint lightTreeReference(uint node, bool second) {
    return loadLightTreeChild(node + (second ? LIGHT_TREE_CHILD_TEXELS : 0u)).reference;
}

// The next of a sequence seeded by 64 random bits (pcg2d of Jarzynski, Olano 2020): a number for each node, since
// one number rescaled from node to node runs out of digits.
uvec2 nextRandom(uvec2 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v ^= v >> 16u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    return v ^ (v >> 16u);
}

// False where no light can reach the point.
bool lightTreeSample(uvec2 random, vec3 p, vec3 n, out uint light, out float pmf) {
    uint node = 0u;
    light = NO_INDEX;
    pmf = 1.0;
    for (uint depth = 0u; depth < LIGHT_TREE_DEPTH; depth++) {
        LightTreeFork f = lightTreeFork(node, p, n);
        if (f.none) return false;
        random = nextRandom(random);
        bool less = random.x < f.threshold;
        pmf *= lightTreeChance(f, less);
        uint reference = lightTreeReference(node, less == f.secondIsLess);
        if ((reference & LIGHT_TREE_LEAF) != 0u) {
            light = reference & ~LIGHT_TREE_LEAF;
            return true;
        }
        node = reference;
    }
    return false;
}

// Probability that lightTreeSample finds this light from this point.
float lightTreePmf(uint light, vec3 p, vec3 n) {
    uint trail = lightAlias(light).trail;
    uint node = 0u;
    float pmf = 1.0;
    for (uint depth = 0u; depth < LIGHT_TREE_DEPTH && pmf > 0.0; depth++) {
        LightTreeFork f = lightTreeFork(node, p, n);
        if (f.none) return 0.0;
        bool second = (trail >> depth & 1u) != 0u;
        pmf *= lightTreeChance(f, second == f.secondIsLess);
        uint reference = lightTreeReference(node, second);
        if ((reference & LIGHT_TREE_LEAF) != 0u) break;
        node = reference;
    }
    return pmf;
}

#endif
