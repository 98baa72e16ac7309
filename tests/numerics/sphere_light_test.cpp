// Cases 8 and 51: lights that are spheres, far away, around the point that they light, and next to it.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/numerics/picture.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/light_probe_runner.h"
#include "tests/support/triangle_scenes.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class HardSphereLight : public DeviceTest {};

AreaLight sphereAt(const glm::dvec3& centre, double radius, float radiance) {
    AreaLight light;
    light.shape = AreaShape::sphere;
    light.position = centre;
    light.radius = radius;
    light.radiance = glm::vec3(radiance);
    return light;
}

/// A square of albedo 1/2 that faces up.
Scene floorOf(float half) {
    Scene scene;
    addMesh(scene, quadMesh({-half, 0, 1.3f * half}, {2 * half, 0, 0}, {0, 0, -2 * half}),
            matte(glm::vec3(0.5f)));
    return scene;
}

// ---- 8

void expectSphereLikeItsMesh(const gpu::Device& device, uint32_t samples) {
    const double distance = 40;
    const float radiance = 1e6f;
    const Camera above = cameraAt({0, 1, 0}, {0, 0, 0}, 1e-4);
    // The tree of lights leaves out the half of the mesh that faces away.
    const Shot shot{.size = 64, .samples = samples, .maxBounces = 1, .lightSelection = LightSelection::tree};
    for (const double radius : {5e-3, 1e-2}) {
        SCOPED_TRACE(radius);
        // A sphere above the whole horizon gives π L (r / d)² cosθ, in full.
        const double expected = 0.5 / pi * pi * double{radiance} * std::pow(radius / distance, 2);
        Scene analytic = floorOf(0.1f), mesh = analytic;
        analytic.areaLights = {sphereAt({0, distance, 0}, radius, radiance)};
        addMesh(mesh, sphereMesh(48), matte(glm::vec3(0), glm::vec3(radiance)),
                glm::scale(glm::translate(glm::dmat4(1), {0, distance, 0}), glm::dvec3(radius)));
        const Mean exact = meanOf(render(device, analytic, above, shot)),
                   ofMesh = meanOf(render(device, mesh, above, shot));
        expectMean(exact, expected, 1e-4 * expected);
        recordWorst("mesh", std::abs(ofMesh.value / exact.value - 1));
        EXPECT_LE(std::hypot(exact.sigma, ofMesh.sigma), 0.0025 * expected) << "noise would hide an error";
        EXPECT_NEAR(ofMesh.value, exact.value, 0.01 * exact.value);
    }
}

TEST_F(HardSphereLight, HardCase08_SphereLikeItsMesh) {
    expectSphereLikeItsMesh(device, 64);
}
TEST_F(HardSphereLight, FullHardCase08_SphereLikeItsMesh) {
    expectSphereLikeItsMesh(device, 512);
}

// ---- 51

TEST_F(HardSphereLight, HardCase51_PointsWithinTheSphereAndOnIt) {
    // The sphere is all that the floor sees: what leaves it is its albedo times the radiance. The lowest
    // point of the sphere is the floor's middle where its centre is 1 above it.
    for (const double height : {0.5, 1 - 1e-6, 1.0}) {
        Scene scene = floorOf(1e-3f);
        scene.areaLights = {sphereAt({0, height, 0}, 1, 2)};
        for (const DirectLight mode : {DirectLight::mis, DirectLight::lights, DirectLight::bsdf}) {
            SCOPED_TRACE(testing::Message() << "centre " << height << " mode " << static_cast<int>(mode));
            const Picture picture = render(device, scene, cameraAt({0, 1e-4, 0}, {0, 0, 0}, 0.5),
                                           {.size = 16, .samples = 64, .maxBounces = 1, .directLight = mode});
            EXPECT_TRUE(allFinite(picture));
            EXPECT_EQ(picture.stats.droppedSamples, 0u);
            const Mean mean = meanOf(picture);
            recordWorst("within", std::abs(mean.value - 1));
            EXPECT_NEAR(mean.value, 1, 0.01) << "sigma " << mean.sigma;
        }
    }
}

/// Irradiance by the light sampling of the kernel, which stands alone here: no camera fits between a point
/// and a sphere 1e-6 above it.
Mean sampledIrradiance(LightProbe& probe, const glm::dvec3& point, int samples) {
    RandomNumbers random(51);
    const auto bits = [&] { return static_cast<uint32_t>(random.bits() >> 32); };
    std::vector<LightQuery> queries(static_cast<size_t>(samples));
    for (LightQuery& q : queries)
        q = {glm::vec4(point, 0), {0, 1, 0, 0}, {}, {bits(), bits(), bits(), bits()}, {}};
    double sum = 0, squares = 0;
    for (const LightAnswer& a : probe.ask(queries)) {
        EXPECT_TRUE(std::isfinite(a.wi.w) && std::isfinite(a.radiance.x) && std::isfinite(a.wi.y));
        const double x =
            a.radiance.w == 0 ? 0 : std::max(double{a.wi.y}, 0.0) * double{a.radiance.x} / double{a.wi.w};
        sum += x;
        squares += x * x;
    }
    const double n = samples, mean = sum / n;
    return {mean, std::sqrt(std::max(squares / n - mean * mean, 0.0) / n)};
}

TEST_F(HardSphereLight, HardCase51_PointsOutsideNextToTheSphere) {
    for (const double gap : {1e-6, 1e-5, 1e-4, 1e-2, 1.0, 100.0}) {
        SCOPED_TRACE(gap);
        Scene scene;
        scene.materials.emplace_back();
        scene.areaLights = {sphereAt({0, 1 + gap, 0}, 1, 1)};
        LightProbe probe(device, scene);
        // Straight below a sphere above the horizon: π (r / d)² cosθ.
        const double expected = pi / std::pow(1 + gap, 2);
        const Mean mean = sampledIrradiance(probe, {0, 0, 0}, 40'000);
        expectMean(mean, expected, 1e-5 * expected);
        EXPECT_LE(mean.sigma * zLimit(), 0.02 * expected);
        EXPECT_NEAR(mean.value, expected, 0.01 * expected);
    }
}

}  // namespace
}  // namespace tilefarm
