#include "tests/bench/bench_scenes.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace tilefarm::bench {
namespace {

using glm::vec3;

/// Deterministic value in [0, 1) of a lattice point.
float lattice(int32_t x, int32_t z) {
    uint32_t h = uint32_t(x) * 0x8da6b343u ^ uint32_t(z) * 0xd8163841u;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return float((h ^ (h >> 15)) >> 8) * 0x1p-24f;
}

float valueNoise(float x, float z) {
    const float fx = std::floor(x), fz = std::floor(z);
    const auto i = int32_t(fx), k = int32_t(fz);
    const float u = x - fx, v = z - fz, su = u * u * (3 - 2 * u), sv = v * v * (3 - 2 * v);
    return glm::mix(glm::mix(lattice(i, k), lattice(i + 1, k), su),
                    glm::mix(lattice(i, k + 1), lattice(i + 1, k + 1), su), sv);
}

float terrainHeight(float x, float z) {
    float height = 0, amplitude = 0.55f, frequency = 1.3f;
    for (int octave = 0; octave < 8; ++octave, amplitude *= 0.5f, frequency *= 2.03f)
        height += amplitude * valueNoise(x * frequency + 17.0f * float(octave), z * frequency);
    return height;
}

Mesh terrain(uint32_t side, uint32_t material) {
    Mesh mesh;
    mesh.name = "terrain";
    mesh.material = material;
    for (uint32_t k = 0; k <= side; ++k)
        for (uint32_t i = 0; i <= side; ++i) {
            const float x = 4.0f * float(i) / float(side) - 2, z = 4.0f * float(k) / float(side) - 2;
            mesh.positions.emplace_back(x, terrainHeight(x, z), z);
        }
    for (uint32_t k = 0; k < side; ++k)
        for (uint32_t i = 0; i < side; ++i) {
            const uint32_t a = k * (side + 1) + i, b = a + 1, c = a + side + 1, d = c + 1;
            mesh.triangles.emplace_back(a, c, b);
            mesh.triangles.emplace_back(b, c, d);
        }
    return mesh;
}

/// Two triangles; the outside is where u x v points.
Mesh rectangle(vec3 corner, vec3 u, vec3 v, uint32_t material) {
    Mesh mesh;
    mesh.name = "wall";
    mesh.material = material;
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

Material lambert(vec3 color, vec3 emission = vec3(0)) {
    Material material;
    material.baseColor = color;
    material.emission = emission;
    material.metallic = 0;
    material.roughness = 1;
    material.ior = 1;
    return material;
}

}  // namespace

void makeLambert(Scene& scene) {
    for (Material& material : scene.materials) {
        const std::string name = material.name;
        material = lambert(material.baseColor, material.emission);
        material.name = name;
    }
    for (Mesh& mesh : scene.meshes) {
        mesh.normals.clear();
        mesh.tangents.clear();
        mesh.colors.clear();
    }
}

Scene terrainRoom(uint32_t side) {
    Scene scene;
    scene.materials = {lambert({0.55f, 0.50f, 0.42f}), lambert({0.72f, 0.72f, 0.70f}),
                       lambert({0.62f, 0.20f, 0.14f}), lambert({0.16f, 0.30f, 0.55f}),
                       lambert(vec3(0), vec3(14.0f, 13.0f, 11.5f))};
    scene.meshes = {
        terrain(side, 0),
        rectangle({-2, 3, -2}, {4, 0, 0}, {0, 0, 4}, 1),           // ceiling
        rectangle({-2, -1, -2}, {4, 0, 0}, {0, 4, 0}, 1),          // back
        rectangle({2, -1, 2}, {-4, 0, 0}, {0, 4, 0}, 1),           // behind the camera
        rectangle({-2, -1, 2}, {0, 0, -4}, {0, 4, 0}, 2),          // left
        rectangle({2, -1, -2}, {0, 0, 4}, {0, 4, 0}, 3),           // right
        rectangle({-0.5f, 2.98f, -0.5f}, {1, 0, 0}, {0, 0, 1}, 4)  // light, facing down
    };
    for (uint32_t m = 0; m < scene.meshes.size(); ++m)
        scene.instances.push_back({m, glm::dmat4(1), scene.meshes[m].name});
    Camera camera;
    camera.name = "Camera";
    camera.yfov = glm::radians(60.0f);
    camera.toWorld = glm::inverse(
        glm::lookAt(glm::dvec3(0.0, 2.1, 1.9), glm::dvec3(0.0, 0.75, -0.6), glm::dvec3(0.0, 1.0, 0.0)));
    scene.cameras = {camera};
    return scene;
}

}  // namespace tilefarm::bench
