#include "tests/support/test_scenes.h"

#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

namespace tilefarm {

Material matte(const glm::vec3& albedo, const glm::vec3& emission) {
    Material m;
    m.baseColor = albedo;
    m.emission = emission;
    m.metallic = 0;
    m.roughness = 1;
    m.ior = 1;
    return m;
}

void addMesh(Scene& scene, Mesh mesh, const Material& material, const glm::dmat4& toWorld) {
    mesh.material = static_cast<uint32_t>(scene.materials.size());
    scene.materials.push_back(material);
    scene.instances.push_back({static_cast<uint32_t>(scene.meshes.size()), toWorld, "node"});
    scene.meshes.push_back(std::move(mesh));
}

Mesh quadMesh(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
    Mesh mesh;
    mesh.positions = {p, p + a, p + a + b, p + b};
    mesh.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

Mesh cubeMesh(bool inwards) {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.f, 1.f}) {
            glm::vec3 n(0), a(0), b(0);
            n[axis] = side;
            a[(axis + 1) % 3] = 2;
            b[(axis + 2) % 3] = 2;
            if ((side < 0) != inwards) std::swap(a, b);
            const Mesh face = quadMesh(n - 0.5f * (a + b), a, b);
            const auto first = static_cast<uint32_t>(mesh.positions.size());
            mesh.positions.insert(mesh.positions.end(), face.positions.begin(), face.positions.end());
            for (const glm::uvec3& t : face.triangles) mesh.triangles.push_back(t + first);
        }
    return mesh;
}

Mesh sphereMesh(int segments) {
    Mesh mesh;
    const int columns = 2 * segments;
    for (int i = 0; i <= segments; ++i)
        for (int j = 0; j <= columns; ++j) {
            const double theta = std::numbers::pi * i / segments,
                         phi = 2 * std::numbers::pi * (j % columns) / columns;
            const double s = i == 0 || i == segments ? 0 : std::sin(theta);
            mesh.positions.emplace_back(s * std::cos(phi), std::cos(theta), s * std::sin(phi));
            mesh.uv0.emplace_back(double(j) / columns, double(i) / segments);
        }
    mesh.normals = mesh.positions;
    for (int i = 0; i < segments; ++i)
        for (int j = 0; j < columns; ++j) {
            const auto a = static_cast<uint32_t>(i * (columns + 1) + j), b = a + 1,
                       c = a + static_cast<uint32_t>(columns) + 1, d = c + 1;
            if (i > 0) mesh.triangles.emplace_back(a, b, c);
            if (i + 1 < segments) mesh.triangles.emplace_back(b, d, c);
        }
    return mesh;
}

Environment uniformEnvironment(const glm::vec3& radiance, uint32_t width, uint32_t height) {
    Environment e;
    e.name = "uniform";
    e.image.width = width;
    e.image.height = height;
    for (uint32_t i = 0; i < width * height; ++i)
        e.image.rgbaFloat.insert(e.image.rgbaFloat.end(), {radiance.r, radiance.g, radiance.b, 1});
    return e;
}

Camera cameraAt(const glm::dvec3& eye, const glm::dvec3& target, double yfov) {
    Camera camera;
    const glm::dvec3 up =
        std::abs(glm::normalize(target - eye).y) > 0.99 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    camera.toWorld = glm::inverse(glm::lookAt(eye, target, up));
    camera.yfov = static_cast<float>(yfov);
    return camera;
}

}  // namespace tilefarm
