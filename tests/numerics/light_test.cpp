// Cases 34 to 37: lights that are tiny, huge, touching, edge on.
#include <cmath>
#include <numbers>

#include "tests/numerics/picture.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/light_probe_runner.h"
#include "tests/support/triangle_scenes.h"
#include "worker/render/light_packer.h"
#include "worker/scene/world.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class HardLight : public DeviceTest {};

Scene floorScene(double half = 5) {
    const auto h = static_cast<float>(half);
    Scene scene;
    addMesh(scene, quadMesh({-h, 0, h}, {2 * h, 0, 0}, {0, 0, -2 * h}), matte(glm::vec3(0.5f)));
    return scene;
}

TEST_F(HardLight, HardCase34_PowersFarApart) {
    Scene scene = floorScene();
    const auto lamp = [&](double x, float emission, float size) {
        addMesh(scene, quadMesh({static_cast<float>(x), 1, -0.5f}, {size, 0, 0}, {0, 0, size}),
                matte(glm::vec3(0), glm::vec3(emission)));
    };
    lamp(-2, 1e30f, 1), lamp(0, 1e-30f, 1), lamp(2, 0, 1), lamp(3, 1, 1e-20f);
    PunctualLight point;
    point.position = {0, 2, 0};
    for (const float intensity : {0.0f, 1e-30f, 1e30f}) {
        point.color = glm::vec3(intensity);
        scene.lights.push_back(point);
    }
    point.type = PunctualType::spot;
    point.innerCone = point.outerCone = 0;
    scene.lights.push_back(point);
    const PackedLights lights = packLights(scene, flatten(scene), 0);
    double sum = 0;
    for (const gpu::LightRecord& light : lights.records) {
        ASSERT_TRUE(std::isfinite(light.pmf));
        sum += double{light.pmf};
    }
    recordWorst("pmf", std::abs(sum - 1));
    EXPECT_NEAR(sum, 1, 1e-6);
    // Two triangles at 1e30, two at 1e-30, the two lamps with power, the spot; not those of zero area or
    // power.
    EXPECT_EQ(lights.records.size(), 7u);
    const Picture picture =
        render(device, scene, cameraAt({1, 1, 2}, {0, 0, 0}, 0.5), {.size = 8, .samples = 8});
    EXPECT_TRUE(std::isfinite(meanOf(picture).value));
    EXPECT_GT(meanOf(picture).value, 0);
    EXPECT_EQ(picture.stats.droppedSamples, 0u);
}

/// Radiance of the floor around `at`, seen from straight above in a field so narrow that it is one point; the
/// floor is so small that its points have digits.
Mean lookAt(const gpu::Device& device, const Scene& scene, const glm::dvec3& at, double height,
            const Shot& shot) {
    return meanOf(render(device, scene, cameraAt(at + glm::dvec3(0, height, 0), at, 1e-4), shot));
}

void expectTouchingLight(const gpu::Device& device, uint32_t samples) {
    for (const double distance : {1.0, 1e-2, 1e-4, 1e-6}) {
        Scene scene;
        const auto d = static_cast<float>(distance);
        addMesh(scene, quadMesh({-d, 0, 2 * d}, {2 * d, 0, 0}, {0, 0, -2 * d}), matte(glm::vec3(0.5f)));
        addMesh(scene, quadMesh({-1, 0, 0}, {2, 0, 0}, {0, 2, 0}), matte(glm::vec3(0), glm::vec3(3)));
        const glm::dvec3 at(0, 0, distance);
        const double irradiance =
            3 * polygonIrradiance({{-1, 0, 0}, {1, 0, 0}, {1, 2, 0}, {-1, 2, 0}}, at, {0, 1, 0});
        const Mean mean =
            lookAt(device, scene, at, 0.1 * distance, {.size = 16, .samples = samples, .maxBounces = 1});
        SCOPED_TRACE(distance);
        expectMean(mean, 0.5 / pi * irradiance, 1e-5);
        EXPECT_LT(mean.sigma, 0.03 * mean.value) << "noise would hide an error";
    }
}

TEST_F(HardLight, HardCase35_LightTouchingTheFloor) {
    expectTouchingLight(device, 64);
}
TEST_F(HardLight, FullHardCase35_LightTouchingTheFloor) {
    expectTouchingLight(device, 4096);
}

TEST_F(HardLight, HardCase35_PointsBetweenTwoTrianglesOfAPlane) {
    // The point is on the diagonal of one floor and within a triangle of the other: at equal seeds the same
    // light. A ray that starts within rounding of an edge may meet the neighbour, the more so at grazing
    // angles; it took 0.19 % of this light before the bound of such points knew the size of the triangles.
    const auto floorsLight = [&](float size) {
        Scene scene;
        addMesh(scene, quadMesh({-size / 2, 0, size}, {size, 0, 0}, {0, 0, -size}), matte(glm::vec3(0.5f)));
        addMesh(scene, quadMesh({-1, 0, 0}, {2, 0, 0}, {0, 2, 0}), matte(glm::vec3(0), glm::vec3(3)));
        return meanOf(
            render(device, scene, cameraAt({0, 0.1, 1}, {0, 0, 1}, 1e-4),
                   {.size = 16, .samples = 128, .maxBounces = 1, .directLight = DirectLight::lights}));
    };
    const double within = floorsLight(10).value, between = floorsLight(2).value;
    recordWorst("lost", std::abs(between / within - 1));
    EXPECT_NEAR(between, within, 1e-5 * within);
}

TEST_F(HardLight, HardCase36_TinyLightSeenEdgeOn) {
    // 1e-3 wide, 10 away, and its normal 89.9° from the direction to the floor.
    const double tilt = glm::radians(89.9);
    const glm::dvec3 along(std::cos(tilt), std::sin(tilt), 0),
        across(0, 0, 1);  // the normal is (sin, −cos, 0)
    const glm::dvec3 corner = glm::dvec3(0, 10, 0) - 0.5e-3 * (along + across);
    Scene scene = floorScene(0.1);
    addMesh(scene, quadMesh(corner, 1e-3 * along, 1e-3 * across), matte(glm::vec3(0), glm::vec3(1e9f)));
    scene.materials.back().doubleSided = true;
    const Mesh& lamp = scene.meshes.back();
    const std::vector<glm::dvec3> corners(lamp.positions.begin(), lamp.positions.end());
    const double irradiance = 1e9 * polygonIrradiance(corners, {0, 0, 0}, {0, 1, 0});
    const Mean mean = lookAt(device, scene, {0, 0, 0}, 1, {.size = 8, .samples = 64, .maxBounces = 1});
    recordWorst("relative", std::abs(mean.value / (0.5 / pi * irradiance) - 1));
    EXPECT_NEAR(mean.value, 0.5 / pi * irradiance, 0.01 * 0.5 / pi * irradiance);
}

TEST_F(HardLight, HardCase37_SpotsAndPointsAtTheirLimits) {
    const auto lit = [&](const PunctualLight& light, const glm::dvec3& at, double half) {
        Scene scene = floorScene(half);
        for (glm::vec3& p : scene.meshes[0].positions) p += glm::vec3(at);
        scene.lights = {light};
        const Picture picture = render(device, scene, cameraAt(at + glm::dvec3(0, half, 0), at, 1e-4),
                                       {.size = 8, .samples = 1, .maxBounces = 1});
        EXPECT_EQ(picture.stats.droppedSamples, 0u);
        return meanOf(picture).value;
    };
    const auto formula = [](double intensity, double height, double aside) {
        const double squared = height * height + aside * aside;
        return 0.5 / pi * intensity * height / std::sqrt(squared) / squared;
    };
    PunctualLight spot;
    spot.type = PunctualType::spot;
    spot.color = glm::vec3(3);
    spot.position = {0, 2, 0};
    spot.direction = {0, -1, 0};
    const auto expectSpot = [&](float inner, float outer, double aside, double expected) {
        spot.innerCone = inner;
        spot.outerCone = outer;
        const double off = std::abs(lit(spot, {aside, 0, 0}, 0.5) - expected) / formula(3, 2, aside);
        recordWorst("spot", off);
        EXPECT_LE(off, 1e-4) << inner << " " << outer;
    };
    expectSpot(0.5f, 0.5f, 1.0, formula(3, 2, 1.0));  // atan 0.5 = 0.46 < 0.5
    expectSpot(0.5f, 0.5f, 1.2, 0);                   // 0.54
    expectSpot(0, 0, 1e-2, 0);
    const auto right = static_cast<float>(pi / 2);
    expectSpot(right, right, 20, formula(3, 2, 20));
    expectSpot(0, right, 0, formula(3, 2, 0));

    PunctualLight point;
    point.color = glm::vec3(2);
    for (const double distance : {1.0, 1e-3, 1e-6}) {
        point.position = {0, distance, 0};
        const double expected = formula(2, distance, 0);
        const double off = std::abs(lit(point, {0, 0, 0}, distance) / expected - 1);
        recordWorst("point", off);
        EXPECT_LE(off, 1e-4) << distance;
    }
}

// ---- 38

Scene manyLamps(uint32_t count) {
    Scene scene = floorScene();
    RandomNumbers random(38);
    for (uint32_t i = 0; i < count; ++i) {
        PunctualLight lamp;
        lamp.position = {random.between(-5, 5), random.between(0.2f, 1), random.between(-5, 5)};
        lamp.color = glm::vec3(random.between(0.1f, 1));
        scene.lights.push_back(lamp);
    }
    return scene;
}

TEST_F(HardLight, HardCase38_TenThousandLights) {
    const Scene scene = manyLamps(10'000);
    const auto mean = [&](LightSelection selection, uint32_t samples) {
        return meanOf(render(device, scene, cameraAt({1, 1.5, 1}, {0.5, 0, 0.5}, 0.2),
                             {.size = 16, .samples = samples, .maxBounces = 1, .lightSelection = selection}));
    };
    const Mean tree = mean(LightSelection::tree, 32), uniform = mean(LightSelection::uniform, 128);
    expectSameMean(tree, uniform);
    EXPECT_LT(tree.sigma, uniform.sigma) << "with a quarter of the samples";

    LightProbe probe(device, scene, [] {
        RenderSettings settings;
        settings.lightSelection = LightSelection::tree;
        return settings;
    }());
    std::vector<LightQuery> queries;
    for (uint32_t i = 0; i < 2000; ++i) {
        LightQuery query{};
        query.position = glm::vec4(0.005f * float(i) - 5, 0, 1, 0);
        query.normal = glm::vec4(0, 1, 0, 0);
        query.bits = glm::uvec4(i * 2654435761u, i * 40503u * 65537u, 0, 0);
        query.ask = glm::uvec4(PROBE_TREE, 0, i, 0);
        queries.push_back(query);
    }
    for (const LightAnswer& a : probe.ask(queries)) {
        recordWorst("pmf", std::abs(double{a.chosen.z} / double{a.chosen.y} - 1));
        ASSERT_NEAR(a.chosen.z, a.chosen.y, 1e-5f * a.chosen.y);
    }
}

}  // namespace
}  // namespace tilefarm
