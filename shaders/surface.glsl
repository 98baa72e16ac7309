// A hit turned into a surface point: position with its error bound, normals, texture coordinates.
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

struct Surface {
    vec3 position;
    vec3 positionError;  // bound on |computed − exact| per coordinate
    vec3 geometricNormal;  // on the side of wo
    mat3 frame;            // shading frame: tangent, bitangent, normal; the normal on the side of wo
    vec2 uv0, uv1;
    vec4 color;
    uint primitive;
    uint material;
    vec3 coatNormal;  // of the clearcoat, on the side of wo; only with FEATURE_CLEARCOAT
    bool frontFace;  // wo sees the side that the winding faces
    bool coincides;  // other faces are where it is (coincident.glsl)
};

const float MACHINE_EPSILON = 5.9604645e-8;  // 2^-24
// γ(n) bounds the relative error of n roundings (Higham 2002; PBRT 4th ed., 6.8.1).
float gammaBound(float n) { return n * MACHINE_EPSILON / (1.0 - n * MACHINE_EPSILON); }

// The next float away from zero on either side, so that rounding the offset cannot undo it.
float nextAwayFrom(float value, float direction) {
    if (direction == 0.0) return value;
    int bits = floatBitsToInt(value);
    if (value == 0.0) return intBitsToFloat(direction > 0.0 ? 1 : int(0x80000001u));
    return intBitsToFloat(bits + ((direction > 0.0) == (value > 0.0) ? 1 : -1));
}

// Where a ray that leaves `position` towards `direction` starts: outside the box of the point's
// error, on the direction's side (PBRT 4th ed., 6.8.6).
vec3 offsetOrigin(vec3 position, vec3 error, vec3 normal, vec3 direction) {
    float distance = dot(abs(normal), error);
    vec3 offset = dot(direction, normal) < 0.0 ? -distance * normal : distance * normal;
    vec3 origin = position + offset;
    return vec3(nextAwayFrom(origin.x, offset.x), nextAwayFrom(origin.y, offset.y), nextAwayFrom(origin.z, offset.z));
}

// Parts of the scene's extent within which a ray asks what it meets whether that coincides with where it starts. Far more
// than rounding moves the t of any face of the scene.
const float kStartReach = 1e-5;

// Has a ray start on a surface: it meets neither that nor what coincides with it. Points in fog have no normal.
void startOn(Surface s, inout Ray ray) {
    ray.skipPrimitive = s.primitive;
    if (!has(FEATURE_COINCIDENT_FACES)) return;
    float sine = abs(dot(s.geometricNormal, ray.direction));
    ray.startNormal = packStartNormal(s.geometricNormal);
    ray.startReach = sine > 0.0 ? kStartReach * parameters.extent / sine : 0.0;
}

// Corners of the triangle that was hit: a texel holds one coordinate of all three.
void loadCorners(Hit hit, out vec3 corner[3]) {
    vec3 x = LOAD_FLOATS(bvhTriangles, hit.triangle).xyz;
    vec3 y = LOAD_FLOATS(bvhTriangles, hit.triangle + 1u).xyz;
    vec3 z = LOAD_FLOATS(bvhTriangles, hit.triangle + 2u).xyz;
    for (int i = 0; i < 3; i++) corner[i] = vec3(x[i], y[i], z[i]);
}

struct VertexIndices {
    uint a, b, c, material;
};

VertexIndices loadPrimitive(uint primitive) {
    uvec4 t = LOAD(primitiveTexels, primitive * PRIMITIVE_TEXELS);
    return VertexIndices(t.x, t.y, t.z, t.w);
}

vec4 vertexTexel(uint vertex, uint texel) { return uintBitsToFloat(LOAD(vertexTexels, vertex * VERTEX_TEXELS + texel)); }

vec4 interpolateTexel(VertexIndices v, vec3 b, uint texel) {
    return b.x * vertexTexel(v.a, texel) + b.y * vertexTexel(v.b, texel) + b.z * vertexTexel(v.c, texel);
}

void loadTexCoords(VertexIndices v, vec3 b, float u0, out vec2 uv0, out vec2 uv1) {
    uv0 = uv1 = vec2(0);
    if (VERTEX_TEXELS > 1u) {
        vec4 t = interpolateTexel(v, b, 1u);
        uv0 = vec2(u0, t.x);
        uv1 = t.yz;
    }
}

// From the first corner on, so that one colour at all corners stays what it is to the last bit.
vec4 loadColor(VertexIndices v, vec3 b) {
    if (!has(FEATURE_VERTEX_COLORS)) return vec4(1);
    precise vec4 a = vertexTexel(v.a, 3u);
    precise vec4 color = a + (b.y * (vertexTexel(v.b, 3u) - a) + b.z * (vertexTexel(v.c, 3u) - a));
    return color;
}

// Bends a shading normal just as far as the mirror image of wo needs to stay above the surface, so
// that neither steep normal maps nor coarse meshes give black bands (Keller et al. 2017, A.3).
vec3 consistentNormal(vec3 ns, vec3 ng, vec3 wo) {
    vec3 r = 2.0 * dot(ns, wo) * ns - wo;
    float above = dot(r, ng);
    float least = min(0.9 * dot(wo, ng), 0.01);
    if (above >= least) return ns;
    vec3 lifted = normalize(r + (least - above) * ng);
    vec3 bent = wo + lifted;
    float squared = dot(bent, bent);
    return squared > 0.0 ? bent * inversesqrt(squared) : ng;
}

// `handedness` is the tangent's w, not interpolated.
vec3 mappedNormal(vec4 tangent, float handedness, vec3 n, uint normalTexture, float scale, vec2 uv0, vec2 uv1) {
    float squared = dot(tangent.xyz, tangent.xyz);
    if (!(squared > 0.0)) return n;
    vec3 t = sampleTexture(normalTexture, uv0, uv1).xyz * 2.0 - 1.0;
    t.xy *= scale;
    // MikkTSpace: neither axis is re-orthogonalised; only the result is normalised.
    vec3 bitangent = cross(n, tangent.xyz) * (handedness < 0.0 ? -1.0 : 1.0);
    vec3 mapped = t.x * tangent.xyz + t.y * bitangent + t.z * n;
    float length2 = dot(mapped, mapped);
    return length2 > 0.0 ? mapped * inversesqrt(length2) : n;
}

// The coat lies over the bumps of the base: it has a normal map of its own, or none.
vec3 coatNormal(Surface s, vec4 tangent, vec3 n, vec3 wo) {
    if (has(FEATURE_NORMAL_MAPS)) {
        uint normalTexture = materialClearcoatNormalTexture(s.material);
        if (normalTexture != NO_INDEX) {
            float scale = materialClearcoatNormalScale(s.material);
            n = mappedNormal(tangent, tangent.w, n, normalTexture, scale, s.uv0, s.uv1);
        }
    }
    return consistentNormal(dot(n, s.geometricNormal) < 0.0 ? -n : n, s.geometricNormal, wo);
}

// The shading frame around a normal. Its tangent means something only where roughness depends on it
// (KHR_materials_anisotropy): then it is the direction that material and texture turn away from the mesh's
// tangent, in the tangent plane of `ns`, the normal before bumps and sides bent it to `n`.
mat3 shadingFrame(Surface s, vec4 tangent, vec3 ns, vec3 n) {
    mat3 frame = frameAround(n);
    if (!has(FEATURE_ANISOTROPY)) return frame;
    vec3 anisotropy = vec3(materialAnisotropy(s.material), materialAnisotropyCos(s.material), materialAnisotropySin(s.material));
    if (!(anisotropy.x > 0.0)) return frame;
    vec2 turn = anisotropy.yz;
    uint index = materialAnisotropyTexture(s.material);
    if (has(FEATURE_TEXTURES) && index != NO_INDEX) {
        vec2 d = sampleTexture(index, s.uv0, s.uv1).xy * 2.0 - 1.0;
        turn = vec2(turn.x * d.x - turn.y * d.y, turn.y * d.x + turn.x * d.y);
    }
    vec3 bitangent = cross(ns, tangent.xyz) * (tangent.w < 0.0 ? -1.0 : 1.0);
    vec3 along = turn.x * tangent.xyz + turn.y * bitangent;
    along -= dot(along, n) * n;
    float squared = dot(along, along);
    // Meshes and texels without a direction: the rough axis is any.
    if (!(squared > 1e-12)) return frame;
    along *= inversesqrt(squared);
    return mat3(along, cross(n, along), n);
}

// The point of a shape, surfaces other than triangles.
Surface shapeSurface(Hit hit, Ray ray) {
    ShapePoint p = shapePointAt(shapeOf(hit), ray.origin, ray.direction, hit.t, true);
    Surface s;
    s.position = p.position;
    s.positionError = p.error;
    s.frontFace = dot(p.normal, ray.direction) <= 0.0;
    s.coincides = false;
    s.geometricNormal = s.frontFace ? p.normal : -p.normal;
    s.primitive = hit.primitive;
    s.material = p.material;
    s.uv0 = s.uv1 = p.uv;
    s.color = vec4(1);
    vec3 ns = p.normal;
    if (has(FEATURE_CLEARCOAT)) s.coatNormal = coatNormal(s, p.tangent, ns, -ray.direction);
    if (has(FEATURE_NORMAL_MAPS)) {
        uint normalTexture = materialNormalTexture(s.material);
        if (normalTexture != NO_INDEX) {
            float scale = materialNormalScale(s.material);
            ns = mappedNormal(p.tangent, p.tangent.w, ns, normalTexture, scale, s.uv0, s.uv1);
        }
    }
    if (dot(ns, s.geometricNormal) < 0.0) ns = -ns;
    s.frame = shadingFrame(s, p.tangent, p.normal, consistentNormal(ns, s.geometricNormal, -ray.direction));
    return s;
}

// The surface that a ray has hit.
Surface surfaceAt(Hit hit, Ray ray) {
    if (has(FEATURE_SHAPES) && isShape(hit)) return shapeSurface(hit, ray);
    vec3 wo = -ray.direction;
    Surface s;
    vec3 corner[3];
    loadCorners(hit, corner);
    // What rounding took from 1 − u − v (Knuth's TwoSum twice): times a far corner it would leave the plane by more
    // than the bound below, which takes the three weights as exact.
    precise float above = 1.0 - hit.barycentrics.x;
    precise float lostAbove = (1.0 - above) - hit.barycentrics.x;
    precise float weight = above - hit.barycentrics.y;
    precise float taken = above - weight;
    precise float lost = lostAbove + ((above - (weight + taken)) + (taken - hit.barycentrics.y));
    vec3 b = vec3(weight, hit.barycentrics);
    precise vec3 position = b.x * corner[0] + b.y * corner[1] + b.z * corner[2] + lost * corner[0];
    s.position = position;
    s.positionError = gammaBound(7.0) * (abs(b.x * corner[0]) + abs(b.y * corner[1]) + abs(b.z * corner[2]));

    // Slivers and tiny triangles: scaling the edges keeps the cross product from underflowing.
    vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    // Within rounding of an edge a ray may be inside of the neighbour too, whose t is off by some roundings of its size
    // and not of its coordinates: of two triangles in the plane y = 0 the bound above knows nothing.
    if (min(b.x, min(b.y, b.z)) < 1e-6)
        s.positionError += gammaBound(32.0) * maxComponent(max(abs(e1), abs(e2)));
    e1 /= max(maxComponent(abs(e1)), 1e-37);
    e2 /= max(maxComponent(abs(e2)), 1e-37);
    vec3 ng = normalize(cross(e1, e2));
    s.frontFace = dot(ng, wo) >= 0.0;
    s.coincides = false;
    s.geometricNormal = s.frontFace ? ng : -ng;

    s.primitive = hit.primitive;
    VertexIndices v = loadPrimitive(hit.primitive);
    s.material = v.material;
    vec4 first = interpolateTexel(v, b, 0u);
    float squared = dot(first.xyz, first.xyz);
    vec3 ns = squared > 0.0 ? first.xyz * inversesqrt(squared) : ng;
    vec3 smoothNormal = ns;
    loadTexCoords(v, b, first.w, s.uv0, s.uv1);
    s.color = loadColor(v, b);

    if (has(FEATURE_CLEARCOAT)) {
        vec4 tangent = vec4(0);
        if (has(FEATURE_NORMAL_MAPS)) tangent = vec4(interpolateTexel(v, b, 2u).xyz, vertexTexel(v.a, 2u).w);
        s.coatNormal = coatNormal(s, tangent, ns, wo);
    }
    if (has(FEATURE_NORMAL_MAPS)) {
        uint normalTexture = materialNormalTexture(s.material);
        if (normalTexture != NO_INDEX) {
            float scale = materialNormalScale(s.material);
            ns = mappedNormal(interpolateTexel(v, b, 2u), vertexTexel(v.a, 2u).w, ns, normalTexture, scale, s.uv0, s.uv1);
        }
    }
    // The winding decides the side; attribute normals may disagree with it and follow.
    if (dot(ns, s.geometricNormal) < 0.0) ns = -ns;
    vec4 along = vec4(0);
    if (has(FEATURE_ANISOTROPY)) along = vec4(interpolateTexel(v, b, 2u).xyz, vertexTexel(v.a, 2u).w);
    s.frame = shadingFrame(s, along, smoothNormal, consistentNormal(ns, s.geometricNormal, wo));
    return s;
}

#endif
