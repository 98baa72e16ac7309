#include "tests/support/triangle_scenes.h"

#include <cmath>
#include <functional>

namespace tilefarm {
namespace {

constexpr double kPi = 3.14159265358979323846;

void addQuad(Triangles& to, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    to.insert(to.end(), {a, b, c, a, c, d});
}

// A box turned about y, without its bottom.
void addBlock(Triangles& to, glm::vec3 base, glm::vec3 halfSize, float angle) {
    const float c = std::cos(angle), s = std::sin(angle);
    const auto corner = [&](float x, float y, float z) {
        x *= halfSize.x, z *= halfSize.z;
        return base + glm::vec3(c * x + s * z, y * 2 * halfSize.y, c * z - s * x);
    };
    const float xs[4] = {-1, 1, 1, -1}, zs[4] = {-1, -1, 1, 1};
    for (int i = 0; i < 4; ++i) {
        const int j = (i + 1) % 4;
        addQuad(to, corner(xs[i], 0, zs[i]), corner(xs[j], 0, zs[j]), corner(xs[j], 1, zs[j]),
                corner(xs[i], 1, zs[i]));
    }
    addQuad(to, corner(-1, 1, -1), corner(1, 1, -1), corner(1, 1, 1), corner(-1, 1, 1));
    addQuad(to, corner(-1, 0, -1), corner(1, 0, -1), corner(1, 0, 1), corner(-1, 0, 1));
}

void addRoom(Triangles& to, bool floor, bool front) {
    const auto p = [](float x, float y, float z) { return glm::vec3(x, y, z); };
    if (floor) addQuad(to, p(-1, -1, -1), p(-1, -1, 1), p(1, -1, 1), p(1, -1, -1));
    addQuad(to, p(-1, 1, -1), p(1, 1, -1), p(1, 1, 1), p(-1, 1, 1));
    addQuad(to, p(-1, -1, -1), p(1, -1, -1), p(1, 1, -1), p(-1, 1, -1));
    addQuad(to, p(-1, -1, -1), p(-1, 1, -1), p(-1, 1, 1), p(-1, -1, 1));
    addQuad(to, p(1, -1, -1), p(1, -1, 1), p(1, 1, 1), p(1, 1, -1));
    if (front) addQuad(to, p(-1, -1, 1), p(-1, 1, 1), p(1, 1, 1), p(1, -1, 1));
    addQuad(to, p(-0.25f, 0.99f, -0.25f), p(0.25f, 0.99f, -0.25f), p(0.25f, 0.99f, 0.25f),
            p(-0.25f, 0.99f, 0.25f));
}

Triangles sphere(uint32_t rings, uint32_t segments,
                 const std::function<glm::vec3(glm::dvec3, uint32_t)>& place) {
    // One placed vertex per grid point; poles and seam are the same vertex for all triangles around them.
    const auto index = [&](uint32_t ring, uint32_t segment) {
        if (ring == 0) return 0u;
        if (ring == rings) return 1u;
        return 2 + (ring - 1) * segments + segment % segments;
    };
    std::vector<glm::vec3> vertices(2 + (rings - 1) * segments);
    for (uint32_t ring = 0; ring <= rings; ++ring)
        for (uint32_t segment = 0; segment < segments; ++segment) {
            const double theta = kPi * ring / rings, phi = 2 * kPi * segment / segments;
            const double s = ring == 0 || ring == rings ? 0 : std::sin(theta);
            const uint32_t at = index(ring, segment);
            vertices[at] = place({s * std::cos(phi), std::cos(theta), s * std::sin(phi)}, at);
        }
    Triangles triangles;
    for (uint32_t ring = 0; ring < rings; ++ring)
        for (uint32_t segment = 0; segment < segments; ++segment) {
            const glm::vec3 a = vertices[index(ring, segment)], b = vertices[index(ring, segment + 1)];
            const glm::vec3 c = vertices[index(ring + 1, segment)],
                            d = vertices[index(ring + 1, segment + 1)];
            if (ring != 0) triangles.insert(triangles.end(), {a, b, c});
            if (ring + 1 != rings) triangles.insert(triangles.end(), {b, d, c});
        }
    return triangles;
}

double heightAt(double x, double z) {
    double height = 0, scale = 0.16, frequency = 3;
    for (int octave = 0; octave < 7; ++octave) {
        height += scale * std::sin(frequency * x + 1.3 * octave) * std::cos(frequency * z + 2.1 * octave);
        const double turned = 0.8 * x - 0.6 * z;
        z = 0.6 * x + 0.8 * z, x = turned;
        scale *= 0.5, frequency *= 2.1;
    }
    return -0.6 + height;
}

}  // namespace

uint64_t RandomNumbers::bits() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

glm::vec3 RandomNumbers::direction() {
    const double z = 2 * unit() - 1, phi = 2 * kPi * unit(), s = std::sqrt(std::max(0.0, 1 - z * z));
    return {s * std::cos(phi), s * std::sin(phi), z};
}

Triangles sphereMesh(glm::vec3 centre, float radius, uint32_t rings, uint32_t segments) {
    return sphere(rings, segments, [&](glm::dvec3 unit, uint32_t) {
        return glm::vec3(glm::dvec3(centre) + double(radius) * unit);
    });
}

Triangles bumpySphere(float least, float most, uint32_t rings, uint32_t segments, uint64_t seed) {
    return sphere(rings, segments, [&](glm::dvec3 unit, uint32_t vertex) {
        return glm::vec3(double(RandomNumbers(seed + vertex).between(least, most)) * unit);
    });
}

Triangles triangleSoup(uint32_t count, float size, uint64_t seed) {
    RandomNumbers random(seed);
    Triangles triangles;
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec3 at(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
        for (int corner = 0; corner < 3; ++corner) triangles.push_back(at + size * random.direction());
    }
    return triangles;
}

Triangles cornellBox() {
    Triangles triangles;
    addRoom(triangles, true, false);
    addBlock(triangles, {0.35f, -1, 0.3f}, {0.3f, 0.3f, 0.3f}, 0.3f);
    addBlock(triangles, {-0.35f, -1, -0.3f}, {0.3f, 0.6f, 0.3f}, -0.35f);
    return triangles;
}

Triangles terrain(uint32_t cells) {
    Triangles triangles;
    addRoom(triangles, false, true);
    const auto vertex = [&](uint32_t i, uint32_t j) {
        const double x = 2.0 * i / cells - 1, z = 2.0 * j / cells - 1;
        return glm::vec3(x, heightAt(x, z), z);
    };
    for (uint32_t i = 0; i < cells; ++i)
        for (uint32_t j = 0; j < cells; ++j)
            addQuad(triangles, vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j));
    return triangles;
}

std::vector<TestRay> cameraRays(glm::vec3 eye, glm::vec3 target, float tanHalfFov, uint32_t width,
                                uint32_t height) {
    const glm::vec3 forward = glm::normalize(target - eye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0, 1, 0)));
    const glm::vec3 up = glm::cross(right, forward);
    std::vector<TestRay> rays;
    for (uint32_t by = 0; by < height; by += 8)
        for (uint32_t bx = 0; bx < width; bx += 8)
            for (uint32_t y = by; y < std::min(by + 8, height); ++y)
                for (uint32_t x = bx; x < std::min(bx + 8, width); ++x) {
                    const float u = (2 * (float(x) + 0.5f) - float(width)) / float(height) * tanHalfFov;
                    const float v = (float(height) - 2 * (float(y) + 0.5f)) / float(height) * tanHalfFov;
                    TestRay ray;
                    ray.origin = eye;
                    ray.direction = glm::normalize(forward + u * right + v * up);
                    rays.push_back(ray);
                }
    return rays;
}

}  // namespace tilefarm
