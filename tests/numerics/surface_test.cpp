// Cases 3, 4, 9, 16, 17: where rays leave surfaces, and what a surface is where its data is bad.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "tests/numerics/picture.h"
#include "tests/numerics/probe_runner.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/triangle_scenes.h"
#include "worker/bvh/bvh.h"
#include "worker/render/light_packer.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

class HardSurface : public DeviceTest {};

// ---- 3

/// Triangles with coordinates ±10^U(−8, 8), those that are not degenerate.
Scene wildTriangles(uint32_t count, RandomNumbers& random) {
    Mesh mesh;
    const auto wild = [&] {
        return std::copysign(std::pow(10.0, random.between(-8, 8)), random.unit() - 0.5);
    };
    for (uint32_t i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) mesh.positions.emplace_back(wild(), wild(), wild());
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    Scene scene;
    addMesh(scene, mesh, matte(glm::vec3(0.5f)));
    return scene;
}

struct SpawnedRays {
    uint64_t rays = 0, selfHits = 0, selfHitsTold = 0, beyondBound = 0;
};

SpawnedRays spawnRays(const gpu::Device& device, uint32_t triangles, uint32_t raysEach) {
    RandomNumbers random(3);
    const Scene scene = wildTriangles(triangles, random);
    const WorldGeometry world = flatten(scene);
    const std::vector<glm::vec3> corners = world.corners();
    const Bvh bvh = buildBvh(corners, {});
    std::vector<glm::vec4> queries;
    for (uint32_t texel = 0; texel + 2 < bvh.triangles.size(); texel += 3) {
        const uint32_t primitive = bvh.triangles[texel].w & 0x7fffffffu;
        if (primitive >= world.triangleCount()) continue;  // padding
        for (uint32_t k = 0; k < raysEach; ++k) {
            float u = random.between(0, 1), v = random.between(0, 1);
            if (u + v > 1) u = 1 - u, v = 1 - v;
            queries.emplace_back(std::bit_cast<float>(texel), std::bit_cast<float>(primitive), u, v);
            queries.emplace_back(random.direction(), 0);
        }
    }
    const auto count = static_cast<uint32_t>(queries.size() / 2);
    const auto answer = Probe(device, scene).run(PROBE_SPAWNED_RAYS, count, queries, 3).values;
    SpawnedRays result;
    result.rays = count;
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec4 position = answer[3 * i], error = answer[3 * i + 1];
        result.selfHits += position.w != 0;
        result.selfHitsTold += error.w != 0;
        const glm::vec3* corner = &corners[3 * std::bit_cast<uint32_t>(queries[2 * i].y)];
        const double u = queries[2 * i].z, v = queries[2 * i].w;
        const glm::dvec3 exact =
            (1 - u - v) * glm::dvec3(corner[0]) + u * glm::dvec3(corner[1]) + v * glm::dvec3(corner[2]);
        const glm::dvec3 off = glm::abs(glm::dvec3(position) - exact);
        result.beyondBound += off.x > error.x || off.y > error.y || off.z > error.z;
    }
    return result;
}

void expectNoSelfHits(const SpawnedRays& result) {
    ASSERT_GT(result.rays, 1000u);
    EXPECT_EQ(result.selfHitsTold, 0u) << "of " << result.rays << " rays that skip their triangle";
    EXPECT_EQ(result.beyondBound, 0u) << "positions further off than their bound says";
    // By the offset alone, that is without skipping, as triangles next to this one see the ray. Coordinates
    // that differ by sixteen orders of magnitude within a triangle leave its edge functions no digits: 17 %
    // of the rays would meet it. Rays of the renderer skip it.
    recordWorst("self_hits_without_skipping",
                static_cast<double>(result.selfHits) / static_cast<double>(result.rays));
}

TEST_F(HardSurface, HardCase03_Reintersection) {
    expectNoSelfHits(spawnRays(device, 300, 100));
}
TEST_F(HardSurface, FullHardCase03_Reintersection) {
    expectNoSelfHits(spawnRays(device, 1000, 1000));
}

// ---- 4

struct View {
    Scene scene;
    Camera camera;
};

View floorAtScale(double scale) {
    View view;
    const auto at = [&](double x, double y, double z) { return glm::vec3(glm::dvec3(x, y, z) * scale); };
    addMesh(view.scene, quadMesh(at(-1, 0, 1), at(2, 0, 0), at(0, 0, -2)), matte(glm::vec3(1)));
    view.scene.environment = uniformEnvironment(glm::vec3(1));
    view.camera = cameraAt(glm::dvec3(0.1, 0.8, 0.6) * scale, glm::dvec3(0.05, 0, 0.1) * scale, 0.7);
    return view;
}

void sweepScales(const gpu::Device& device, const Shot& shot, const std::vector<int>& twos,
                 const std::vector<int>& tens) {
    const auto rendered = [&](double scale) {
        const View view = floorAtScale(scale);
        const Picture picture = render(device, view.scene, view.camera, shot);
        expectMean(meanOf(picture), 1);
        EXPECT_EQ(blackPixels(picture), 0u) << "at scale " << scale;
        EXPECT_EQ(picture.stats.droppedSamples, 0u);
        return picture;
    };
    const Picture unit = rendered(1);
    for (const int k : twos) EXPECT_LE(relMse(rendered(std::exp2(k)), unit), 1e-6) << "2^" << k;
    for (const int k : tens) rendered(std::pow(10, k));
}

TEST_F(HardSurface, HardCase04_ScaleSweep) {
    sweepScales(device, {.size = 12, .samples = 16}, {-13, 10, 20}, {-4, -1, 3, 6});
}
TEST_F(HardSurface, FullHardCase04_ScaleSweep) {
    std::vector<int> twos, tens;
    for (int k = -13; k <= 20; ++k) twos.push_back(k);
    for (int k = -4; k <= 6; ++k) tens.push_back(k);
    sweepScales(device, {.size = 32, .samples = 64}, twos, tens);
}

// ---- 9 and 16: files whose data is bad, through the loader

class HardFile : public HardSurface {
protected:
    Scene load(GltfBuilder& builder, const std::string& name) {
        Scene scene = loadGltf(builder.writeGlb(folder_.path(), name + ".glb"));
        if (!scene.hasEnvironment()) scene.environment = uniformEnvironment({1, 0.8f, 0.5f});
        return scene;
    }
    Picture picture(const Scene& scene) {
        return render(device, scene, cameraAt({0.4, 0.3, 2}, {0.5, 0.5, 0}, 0.7), {.size = 16, .samples = 8});
    }

    TemporaryFolder folder_;
};

/// A unit square of two triangles, and with `bad` also every kind of triangle that is none.
GltfBuilder squareWith(bool bad, bool emissive) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                    inf = std::numeric_limits<float>::infinity();
    GltfBuilder builder = GltfBuilder::square();
    std::vector<glm::vec3> positions{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    std::vector<uint16_t> indices{0, 1, 2};
    if (bad) {
        positions.insert(positions.end(), {{nan, 0, 0}, {0, inf, 0}, {0.5f, 0.5f, 0}, {0.25f, 0.25f, 0}});
        indices.insert(indices.end(), {0, 0, 1, 1, 1, 1, 0, 1, 4, 2, 5, 3, 0, 6, 7, 0, 2, 6});
    }
    indices.insert(indices.end(), {0, 2, 3});
    const std::string attributes = "/meshes/0/primitives/0/attributes/";
    builder.set(attributes + "POSITION", builder.accessor(positions));
    builder.erase(attributes + "NORMAL").erase(attributes + "TEXCOORD_0");
    builder.set("/meshes/0/primitives/0/indices", builder.accessor(indices, "SCALAR"));
    if (emissive) builder.set("/materials/0", R"({"emissiveFactor": [1, 0.5, 0.25]})");
    return builder;
}

TEST_F(HardFile, HardCase09_DegenerateTriangles) {
    for (const bool emissive : {false, true}) {
        GltfBuilder good = squareWith(false, emissive), bad = squareWith(true, emissive);
        const Scene clean = load(good, "clean"), dirty = load(bad, "dirty");
        EXPECT_EQ(clean.degenerateTriangles, 0u);
        EXPECT_EQ(dirty.degenerateTriangles, 6u);
        EXPECT_TRUE(sameBits(picture(clean), picture(dirty)));
        const WorldGeometry world = flatten(dirty);
        EXPECT_EQ(packLights(dirty, world, 0).records.size(), emissive ? 2u : 0u);
    }
    // A transform that flattens a mesh is found where it is applied: no triangle, no light.
    Scene flat;
    addMesh(flat, cubeMesh(false), matte(glm::vec3(0.5f), glm::vec3(1)),
            glm::scale(glm::dmat4(1), {0, 0, 1}));
    const WorldGeometry world = flatten(flat);
    EXPECT_EQ(world.triangleCount(), 0u);
    EXPECT_EQ(world.degenerateTriangles, 12u);
    EXPECT_TRUE(packLights(flat, world, 0).records.empty());
}

GltfBuilder mapped(const std::vector<glm::vec3>* normals, const std::vector<glm::vec4>* tangents,
                   const std::vector<glm::vec2>* uv, bool normalMap) {
    GltfBuilder builder = GltfBuilder::square();
    const std::string attributes = "/meshes/0/primitives/0/attributes/";
    builder.erase(attributes + "NORMAL").erase(attributes + "TEXCOORD_0");
    if (normals) builder.set(attributes + "NORMAL", builder.accessor(*normals));
    if (tangents) builder.set(attributes + "TANGENT", builder.accessor(*tangents));
    if (uv) builder.set(attributes + "TEXCOORD_0", builder.accessor(*uv));
    if (normalMap) {
        builder.set("/images/0/mimeType", "\"image/png\"");
        builder.set("/images/0/bufferView", builder.view(encodePng(1, 1, 3, 8, {220, 128, 200})));
        builder.set("/textures/0", R"({"source": 0})");
        builder.set("/materials/0", R"({"normalTexture": {"index": 0}})");
    }
    return builder;
}

TEST_F(HardFile, HardCase16_BadNormalsTangentsAndTextureCoordinates) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    using Normals = std::vector<glm::vec3>;
    const auto shown = [&](GltfBuilder builder) { return picture(load(builder, "bad")); };
    const auto expectLike = [&](const Picture& expected, GltfBuilder builder, const char* what) {
        const Picture bad = shown(std::move(builder));
        EXPECT_TRUE(allFinite(bad)) << what;
        EXPECT_EQ(bad.stats.droppedSamples, 0u) << what;
        EXPECT_LE(furthestPixel(bad, expected), 1e-6) << what;
    };
    const Normals up(4, {0, 0, 1}), zero(4, glm::vec3(0)), bad(4, {nan, 0, 1}), opposed(4, {0, 0, -1});
    const Normals mixed{{0, 0, 1}, {0, 0, 0}, {nan, nan, nan}, {0, 0, 1e-30f}};
    const Picture plain = shown(mapped(nullptr, nullptr, nullptr, false));
    for (const auto& [normals, what] : {std::pair(&up, "right normals"),
                                        {&zero, "zero normals"},
                                        {&bad, "NaN normals"},
                                        {&opposed, "opposed normals"},
                                        {&mixed, "some normals bad"}})
        expectLike(plain, mapped(normals, nullptr, nullptr, false), what);
    // A normal map that nothing gives a direction: any will do, and every such mesh gets the same one.
    const std::vector<glm::vec4> noTangents(4, {0, 0, 0, 1}), nanTangents(4, {nan, 0, 0, 1}),
        along(4, {0, 0, 1, 1});
    const std::vector<glm::vec2> onePoint(4, {0.5f, 0.5f}), nanPoints(4, {nan, nan});
    const Picture tilted = shown(mapped(nullptr, nullptr, nullptr, true));
    EXPECT_GT(furthestPixel(tilted, plain), 1e-3);
    expectLike(tilted, mapped(&up, &noTangents, &onePoint, true), "zero tangents");
    expectLike(tilted, mapped(&up, &nanTangents, &onePoint, true), "NaN tangents");
    expectLike(tilted, mapped(&up, &along, &onePoint, true), "tangents along the normal");
    expectLike(tilted, mapped(&up, nullptr, &onePoint, true), "texture coordinates in one point");
    expectLike(tilted, mapped(&up, nullptr, &nanPoints, true), "texture coordinates that are NaN");
}

// ---- 17

/// A floor whose normal map tilts its normal by 80° towards `azimuth`, seen at 4° above it.
View tilted(double azimuth, const Material& base) {
    View view;
    Mesh mesh = quadMesh({-50, 0, 50}, {100, 0, 0}, {0, 0, -100});
    mesh.normals.assign(4, {0, 1, 0});
    mesh.tangents.assign(4, {1, 0, 0, 1});
    const double tilt = glm::radians(80.0);
    const auto byte = [](double value) {
        return static_cast<uint8_t>(std::lround(255 * (0.5 + 0.5 * value)));
    };
    const std::vector<uint8_t> texel{byte(std::sin(tilt) * std::cos(azimuth)),
                                     byte(std::sin(tilt) * std::sin(azimuth)), byte(std::cos(tilt)), 255};
    view.scene.images.push_back({"tilt", 1, 1, texel, {}});
    Material material = base;
    material.normalTexture.image = 0;
    addMesh(view.scene, mesh, material);
    view.scene.environment = uniformEnvironment(glm::vec3(1));
    view.camera = cameraAt({0, 0.7, 10}, {0, 0, 0}, 0.1);
    return view;
}

void expectNoBlackBand(const gpu::Device& device, const Shot& shot, int azimuths) {
    Material metal;
    metal.roughness = 0.3f;
    Material plastic;
    plastic.metallic = 0;
    plastic.roughness = 0.2f;
    for (const Material& material : {matte(glm::vec3(1)), metal, plastic})
        for (int k = 0; k < azimuths; ++k) {
            const View view = tilted(2 * std::numbers::pi * k / azimuths, material);
            const Picture picture = render(device, view.scene, view.camera, shot);
            EXPECT_LE(double(blackPixels(picture)), 0.01 * double(picture.pixels.size())) << "azimuth " << k;
            const Mean mean = meanOf(picture);
            recordWorst("furnace", mean.value);
            recordWorst("black_percent", 100 * double(blackPixels(picture)) / double(picture.pixels.size()));
            EXPECT_LE(mean.value, 1.005 + zLimit() * mean.sigma) << "azimuth " << k;
            EXPECT_TRUE(allFinite(picture));
        }
}

TEST_F(HardSurface, HardCase17_TiltedNormalMapAtGrazingView) {
    expectNoBlackBand(device, {.size = 10, .samples = 32}, 3);
}
TEST_F(HardSurface, FullHardCase17_TiltedNormalMapAtGrazingView) {
    expectNoBlackBand(device, {.size = 32, .samples = 256}, 12);
}

}  // namespace
}  // namespace tilefarm
