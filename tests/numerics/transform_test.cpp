// Cases 5, 13, 14, 15: transforms, and scenes far from the origin.
#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/numerics/picture.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/triangle_scenes.h"
#include "worker/render/light_packer.h"
#include "worker/scene/load.h"
#include "worker/scene/world.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class HardTransform : public DeviceTest {
protected:
    TemporaryFolder folder_;
};

// ---- 5

std::vector<glm::vec3> moved(std::vector<glm::vec3> positions, double by) {
    for (glm::vec3& p : positions) p = glm::vec3(glm::dvec3(p) + glm::dvec3(by, by, -by));
    return positions;
}

/// A ball on a floor and a camera under one parent. `baked`: the vertices themselves are moved.
GltfBuilder ballAt(double offset, bool baked) {
    GltfBuilder builder;
    uint32_t mesh = 0;
    for (const Mesh& part : {sphereMesh(16), quadMesh({-3, -1, 3}, {6, 0, 0}, {0, 0, -6})}) {
        const std::string primitive = fmt::format("/meshes/{}/primitives/0/", mesh);
        builder.set(primitive + "attributes/POSITION",
                    builder.accessor(baked ? moved(part.positions, offset) : part.positions));
        if (!part.normals.empty())
            builder.set(primitive + "attributes/NORMAL", builder.accessor(part.normals));
        std::vector<uint32_t> indices;
        for (const glm::uvec3& t : part.triangles) indices.insert(indices.end(), {t.x, t.y, t.z});
        builder.set(primitive + "indices", builder.accessor(indices, "SCALAR"));
        builder.set(fmt::format("/nodes/{}/mesh", mesh), mesh);
        ++mesh;
    }
    const double by = baked ? offset : 0;
    builder.set("/cameras/0", R"({"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}})");
    builder.set("/nodes/2", fmt::format(R"({{"camera": 0, "translation": [{}, {}, {}]}})", by, by, 5 - by));
    builder.set("/nodes/3", baked ? std::string(R"({"children": [0, 1, 2]})")
                                  : fmt::format(R"({{"children": [0, 1, 2], "translation": [{}, {}, {}]}})",
                                                offset, offset, -offset));
    builder.set("/scenes/0/nodes", "[3]");
    return builder;
}

TEST_F(HardTransform, HardCase05_TranslationSweep) {
    const auto rendered = [&](double offset, bool baked) {
        GltfBuilder builder = ballAt(offset, baked);
        Scene scene = loadGltf(builder.writeGlb(folder_.path(), fmt::format("{}{}.glb", offset, baked)));
        const bool warned = std::any_of(scene.warnings.begin(), scene.warnings.end(),
                                        [](const SceneWarning& w) { return w.feature == "precision loss"; });
        EXPECT_EQ(warned, baked && offset >= 1e4) << offset;
        scene.environment = uniformEnvironment(glm::vec3(1));
        return render(device, scene, selectCamera(scene, "auto", 1), {.size = 32, .samples = 8});
    };
    const Picture unmoved = rendered(0, false);
    for (const double offset : {1e2, 1e4, 1e6}) {
        EXPECT_LE(relMse(rendered(offset, false), unmoved), 1e-4) << "moved by " << offset;
        const Picture baked = rendered(offset, true);
        EXPECT_TRUE(allFinite(baked));
        EXPECT_EQ(baked.stats.droppedSamples, 0u);
    }
}

// ---- 13

/// A square with a normal map that leans towards its tangent, lit from that side; in the mirrored scene
/// everything but the file's data is mirrored in x.
Scene leaning(double side) {
    Scene scene;
    scene.images.push_back({"lean", 1, 1, {218, 160, 200, 255}, {}});
    Material wall = matte({0.8f, 0.6f, 0.4f});
    wall.normalTexture.image = 0;
    Mesh mesh = quadMesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    mesh.normals.assign(4, {0, 0, 1});
    mesh.tangents.assign(4, {1, 0, 0, 1});
    addMesh(scene, mesh, wall, glm::scale(glm::dmat4(1), {side, 1, 1}));
    PunctualLight lamp;
    lamp.position = {2 * side, 1, 1.5};
    lamp.color = glm::vec3(20);
    scene.lights.push_back(lamp);
    return scene;
}

TEST_F(HardTransform, HardCase13_NegativeScale) {
    const auto mean = [&](const Scene& scene, double side) {
        const Camera camera = cameraAt({0.7 * side, 0.2, 4}, {0.1 * side, 0, 0}, 0.4);
        return meanOf(render(device, scene, camera, {.size = 16, .samples = 16, .maxBounces = 1}));
    };
    const Mean right = mean(leaning(1), 1), mirrored = mean(leaning(-1), -1);
    EXPECT_GT(right.value, 0.1);
    recordWorst("mirrored", std::abs(mirrored.value / right.value - 1));
    EXPECT_NEAR(mirrored.value, right.value, 0.005 * right.value);

    // Light leaves the side that the winding faces, in a mirrored instance too.
    Scene glowing;
    addMesh(glowing, quadMesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), matte(glm::vec3(0), glm::vec3(1)),
            glm::scale(glm::dmat4(1), {-1, 1, 1}));
    const Camera before = cameraAt({0, 0, 4}, {0, 0, 0}, 0.1), behind = cameraAt({0, 0, -4}, {0, 0, 0}, 0.1);
    EXPECT_EQ(meanOf(render(device, glowing, before, {.size = 8, .samples = 1})).value, 1);
    EXPECT_EQ(meanOf(render(device, glowing, behind, {.size = 8, .samples = 1})).value, 0);
}

// ---- 14

TEST_F(HardTransform, HardCase14_MeshUnderNonUniformScale) {
    const glm::dvec3 scale(1, 10, 0.1);
    Scene scene;
    addMesh(scene, sphereMesh(48), matte(glm::vec3(0.5f), glm::vec3(3)), glm::scale(glm::dmat4(1), scale));
    const WorldGeometry world = flatten(scene);
    const Mesh& mesh = scene.meshes[0];
    // Two doubles: of the angle between unit vectors the cross product keeps the digits.
    const auto angle = [](const glm::dvec3& a, const glm::dvec3& b) {
        return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
    };
    double furthest = 0;
    for (size_t i = 0; i < mesh.positions.size(); ++i)
        furthest = std::max(furthest, angle(world.normals[i], glm::dvec3(mesh.positions[i]) / scale));
    recordWorst("radians", furthest);
    EXPECT_LE(furthest, 1e-4) << "rad, at the vertices";

    // What the kernel shades with: cameras that look at single vertices along their normal.
    for (const size_t vertex : {size_t{97 * 7 + 11}, size_t{97 * 24 + 40}, size_t{97 * 40 + 80}}) {
        const glm::dvec3 at(world.positions[vertex]), normal(world.normals[vertex]);
        const Picture picture = render(device, scene, cameraAt(at + normal, at, 1e-6),
                                       {.size = 8, .samples = 1, .maxBounces = 0});
        for (const FilmPixel& pixel : picture.pixels)
            ASSERT_LE(angle({pixel.normal[0], pixel.normal[1], pixel.normal[2]}, normal), 1e-4);
    }

    double area = 0, exact = 0;
    for (const EmissiveTriangle& t : world.emissive) area += t.area;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a = glm::dvec3(mesh.positions[t.x]) * scale,
                         b = glm::dvec3(mesh.positions[t.y]) * scale,
                         c = glm::dvec3(mesh.positions[t.z]) * scale;
        exact += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    EXPECT_NEAR(area, exact, 1e-4 * exact);
    // Power against that of a lamp whose power is known: π L A to 4 π I.
    PunctualLight lamp;
    lamp.color = glm::vec3(5);
    scene.lights.push_back(lamp);
    const PackedLights lights = packLights(scene, flatten(scene), 0);
    double triangles = 0, point = 0;
    for (const gpu::LightRecord& light : lights.records)
        (light.type == gpu::LIGHT_TRIANGLE ? triangles : point) += double{light.pmf};
    EXPECT_NEAR(triangles / point, pi * 3 * exact / (4 * pi * 5), 1e-4 * triangles / point);
}

// ---- 15

/// Column-major matrices in long double: the oracle.
using Long = std::array<std::array<long double, 4>, 4>;

Long times(const Long& a, const Long& b) {
    Long r{};
    for (size_t c = 0; c < 4; ++c)
        for (size_t i = 0; i < 4; ++i)
            for (size_t k = 0; k < 4; ++k) r[c][i] += a[k][i] * b[c][k];
    return r;
}

Long trs(const glm::dvec3& t, const std::array<double, 4>& quaternion, const glm::dvec3& s) {
    long double x = quaternion[0], y = quaternion[1], z = quaternion[2], w = quaternion[3];
    const long double length = std::sqrt(x * x + y * y + z * z + w * w);
    x /= length, y /= length, z /= length, w /= length;
    return {{{(1 - 2 * (y * y + z * z)) * s.x, 2 * (x * y + z * w) * s.x, 2 * (x * z - y * w) * s.x, 0},
             {2 * (x * y - z * w) * s.y, (1 - 2 * (x * x + z * z)) * s.y, 2 * (y * z + x * w) * s.y, 0},
             {2 * (x * z + y * w) * s.z, 2 * (y * z - x * w) * s.z, (1 - 2 * (x * x + y * y)) * s.z, 0},
             {t.x, t.y, t.z, 1}}};
}

TEST_F(HardTransform, HardCase15_DeepNodeChain) {
    GltfBuilder builder = GltfBuilder::triangle();
    RandomNumbers random(15);
    const auto next = [&] { return double{random.between(-1, 1)}; };
    Long total{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    builder.set("/scenes/0/nodes", "[1]");
    for (int i = 1; i <= 50; ++i) {
        std::array<double, 4> q{next(), next(), next(), next()};
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        for (double& value : q) value /= length;
        const glm::dvec3 t(next(), next(), next()),
            s(std::exp(0.4 * next()), std::exp(0.4 * next()), std::exp(0.4 * next()));
        builder.set(
            fmt::format("/nodes/{}", i),
            fmt::format(
                R"({{"translation": [{:.17g}, {:.17g}, {:.17g}], "rotation": [{:.17g}, {:.17g}, {:.17g}, {:.17g}],
                                     "scale": [{:.17g}, {:.17g}, {:.17g}], "children": [{}]}})",
                t.x, t.y, t.z, q[0], q[1], q[2], q[3], s.x, s.y, s.z, i < 50 ? i + 1 : 0));
        total = times(total, trs(t, q, s));
    }
    const WorldGeometry world = flatten(loadGltf(builder.writeGlb(folder_.path())));
    ASSERT_EQ(world.triangleCount(), 1u);
    const std::array<std::array<long double, 3>, 3> corners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    double largest = 0, furthest = 0;
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < 3; ++i) {
            const long double exact = total[0][i] * corners[k][0] + total[1][i] * corners[k][1] + total[3][i];
            const glm::vec3 position = world.positions[world.triangles[0][static_cast<int>(k)]];
            const auto axis = static_cast<int>(i);
            const double shown = double{position[axis]} + world.centre[axis];
            largest = std::max(largest, static_cast<double>(std::abs(exact)));
            furthest =
                std::max(furthest, static_cast<double>(std::abs(exact - static_cast<long double>(shown))));
        }
    recordWorst("relative", furthest / largest);
    EXPECT_LE(furthest, 1e-6 * largest);
    EXPECT_GT(furthest, 0) << "the oracle is another computation";
}

}  // namespace
}  // namespace tilefarm
