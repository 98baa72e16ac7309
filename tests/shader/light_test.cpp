// The light that arrives from every kind of light: against closed forms, and light sampling, BSDF sampling
// and both together against each other. By z-tests on images of the real renderer.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/shader/device_fixture.h"
#include "tests/shader/light_probe_runner.h"
#include "tests/shader/light_scenes.h"
#include "tests/shader/render_frame.h"
#include "tests/support/test_scenes.h"
#include "worker/scene/sky.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

/// Irradiance of a polygon of radiance 1: Lambert's formula, 1/2 Σ angle of edge times the cosine of its
/// plane. All of it above the plane of the receiver.
double polygonIrradiance(const std::vector<glm::dvec3>& corners, const glm::dvec3& point,
                         const glm::dvec3& normal) {
    double sum = 0;
    for (size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - point),
                         b = glm::normalize(corners[(i + 1) % corners.size()] - point);
        const glm::dvec3 pole = glm::cross(a, b);
        const double sine = glm::length(pole);
        if (sine > 0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(pole / sine, normal);
    }
    return std::abs(sum) / 2;
}

std::vector<glm::dvec3> cornersOf(const AreaLight& l) {
    return {l.position - l.u - l.v, l.position + l.u - l.v, l.position + l.u + l.v, l.position - l.u + l.v};
}

/// A floor of albedo 1/2 around the origin, facing +y; the edge of its two triangles passes beside it.
void addFloor(Scene& scene, float half = 5) {
    addMesh(scene, quadMesh({-half, 0, 1.3f * half}, {2 * half, 0, 0}, {0, 0, -2 * half}),
            matte(glm::vec3(0.5f)));
}

/// A camera that sees next to nothing but `point` on the floor, from the side.
Camera closeUp(const glm::dvec3& point) {
    return cameraAt(point + glm::dvec3(-0.7, 0.5, 0.6), point, 1e-5);
}

class LightTest : public DeviceTest {
protected:
    Mean radianceAt(const Scene& scene, const glm::dvec3& point, uint32_t samples,
                    DirectLight directLight = DirectLight::mis,
                    LightSelection selection = LightSelection::power, uint32_t seed = 1) {
        RenderSettings settings = bounces(1, seed);
        settings.directLight = directLight;
        settings.lightSelection = selection;
        return meanOf(renderFrame(device, scene, closeUp(point), square(32), settings, samples));
    }

    void expectIrradiance(const Scene& scene, const glm::dvec3& point, double irradiance,
                          uint32_t samples = 64) {
        for (const DirectLight mode : {DirectLight::mis, DirectLight::lights}) {
            SCOPED_TRACE(static_cast<int>(mode));
            expectMean(radianceAt(scene, point, samples, mode), 0.5 / pi * irradiance,
                       1e-3 * irradiance * 0.5 / pi);
        }
    }

    void expectPolygon(const AreaLight& light, const glm::dvec3& point, uint32_t samples = 64) {
        Scene scene;
        addFloor(scene);
        scene.areaLights = {light};
        const double radiance = light.radiance.x;
        expectIrradiance(scene, point, radiance * polygonIrradiance(cornersOf(light), point, {0, 1, 0}),
                         samples);
    }
};

TEST_F(LightTest, QuadGivesLambertsPolygonFormula) {
    expectPolygon(quadLight({0.3, 1.5, 0}, {1, 0, 0}, {0, 0, 1}, 4), {0.7, 0, 0.2});
    EXPECT_NEAR(polygonIrradiance({{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}}, {0, 0, 0}, {0, 1, 0}),
                1.7408395, 1e-6);
}

TEST_F(LightTest, QuadStandsUprightOnTheFloorAndTouchesIt) {
    // Hard case 35. The nearest point is a ten-thousandth of the quad's size away from it.
    const AreaLight wall = quadLight({0, 0.5, -1}, {0, 0.5, 0}, {0.5, 0, 0}, 3);
    AreaLight facing = wall;
    std::swap(facing.u, facing.v);  // towards +z
    for (const double distance : {0.3, 1e-2, 1e-4}) expectPolygon(facing, {0.1, 0, -1 + distance});
}

TEST_F(LightTest, QuadThatIsThinFarAndGrazingKeepsItsIrradiance) {
    // Hard case 36: a thousandth wide at ten units, seen at 89.9° from its normal.
    const double tilt = 89.9 * pi / 180;
    const AreaLight sliver =
        quadLight({0, 10, 0}, {0.0005, 0, 0}, {0, 0.5 * std::sin(tilt), 0.5 * std::cos(tilt)}, 1e6);
    AreaLight facing = sliver;
    if (glm::cross(facing.u, facing.v).y > 0) std::swap(facing.u, facing.v);
    expectPolygon(facing, {0, 0, 0});
}

TEST_F(LightTest, SkewedQuadIsLitAsWell) {
    expectPolygon(quadLight({0.3, 1.5, 0}, {1, 0, 0}, {0.5, 0, 1}, 4), {0.7, 0, 0.2});
}

TEST_F(LightTest, QuadIsSeenFromItsFrontOnlyUnlessItIsTwoSided) {
    Scene scene;
    scene.materials.push_back(matte(glm::vec3(1)));
    scene.areaLights = {quadLight({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 3)};
    const auto seen = [&](double z) {
        return meanOf(
                   renderFrame(device, scene, cameraAt({0, 0, z}, {0, 0, 0}, 0.1), square(8), bounces(1), 1))
            .value;
    };
    EXPECT_EQ(seen(5), 3);
    EXPECT_EQ(seen(-5), 0);
    scene.areaLights[0].twoSided = true;
    EXPECT_EQ(seen(-5), 3);
}

TEST_F(LightTest, QuadFarFromTheOriginIsWhereItIs) {
    Scene scene;
    const glm::dvec3 away(3e6, 0, -2e6);
    addMesh(scene, quadMesh({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}), matte(glm::vec3(0.5f)),
            glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, 1, 0),
                       glm::dvec4(away, 1)));
    const AreaLight light = quadLight(away + glm::dvec3(0.3, 1.5, 0), {1, 0, 0}, {0, 0, 1}, 4);
    scene.areaLights = {light};
    const glm::dvec3 point = away + glm::dvec3(0.7, 0, 0.2);
    expectIrradiance(scene, point, 4 * polygonIrradiance(cornersOf(light), point, {0, 1, 0}));
}

/// Irradiance of a sphere of radiance 1 that is all above the receiver's plane: π (r / d)² cosθ, in full.
double sphereIrradiance(const AreaLight& sphere, const glm::dvec3& point) {
    const glm::dvec3 d = sphere.position - point;
    return pi * sphere.radius * sphere.radius * d.y / std::pow(glm::length(d), 3);
}

TEST_F(LightTest, SphereGivesItsClosedFormNearAndFar) {
    for (const auto& [centre, radius] : {std::pair{glm::dvec3(0.4, 1.5, 0.3), 0.5},
                                         {{0.3, 1, 0}, 0.9},
                                         {{30, 40, 0}, 1.0},
                                         {{0, 4000, 3000}, 1.0}}) {
        SCOPED_TRACE(centre.y);
        Scene scene;
        addFloor(scene);
        const AreaLight light = sphereLight(centre, radius, 1000);
        scene.areaLights = {light};
        expectIrradiance(scene, {0, 0, 0}, 1000 * sphereIrradiance(light, {0, 0, 0}));
    }
}

TEST_F(LightTest, SphereAroundThePointFillsWhatItSees) {
    // Hard case 51, within it and on it.
    for (const double height : {0.5, 1.0}) {
        SCOPED_TRACE(height);
        Scene scene;
        addFloor(scene, 0.02f);
        scene.areaLights = {sphereLight({0, height, 0}, 1, 2)};
        RenderSettings settings = bounces(1);
        for (const DirectLight mode : {DirectLight::mis, DirectLight::lights, DirectLight::bsdf}) {
            settings.directLight = mode;
            expectMean(meanOf(renderFrame(device, scene, cameraAt({0, 1e-4, 0}, {0, 0, 0}, 0.5), square(16),
                                          settings, 64)),
                       0.5 * 2, 0.01);
        }
    }
}

TEST_F(LightTest, SphereThatTheLastDigitsSeparateFromThePointGivesItsIrradiance) {
    // Hard case 51, outside: nothing fits between point and sphere, so the sampling is asked by itself.
    for (const double gap : {0.0, 1e-6, 1e-4, 0.1}) {
        Scene scene;
        scene.materials.emplace_back();
        scene.areaLights = {sphereLight({0, 1, 0}, 1 / (1 + gap), 1)};
        LightProbe probe(device, scene);
        std::mt19937 random(1);
        std::vector<LightQuery> queries(20000);
        for (LightQuery& q : queries)
            q = {{0, 0, 0, 0}, {0, 1, 0, 0}, {}, {random(), random(), random(), random()}, {}};
        double sum = 0;
        for (const LightAnswer& a : probe.ask(queries))
            sum += a.radiance.w == 0 ? 0 : a.wi.y * a.radiance.x / a.wi.w;
        EXPECT_NEAR(sum / 20000, pi / ((1 + gap) * (1 + gap)), 0.02) << gap;
    }
}

TEST_F(LightTest, SphereAgreesWithAFineMeshOfItFarAway) {
    // Hard case 8.
    for (const float radius : {5e-3f, 1e-2f}) {
        Scene analytic, mesh;
        addFloor(analytic);
        addFloor(mesh);
        const AreaLight light = sphereLight({0, 40, 0}, radius, 1e6f);
        analytic.areaLights = {light};
        addMesh(mesh, sphereMesh(32), matte(glm::vec3(0), glm::vec3(1e6f)),
                glm::dmat4(glm::dvec4(radius, 0, 0, 0), glm::dvec4(0, radius, 0, 0),
                           glm::dvec4(0, 0, radius, 0), glm::dvec4(0, 40, 0, 1)));
        const Mean a = radianceAt(analytic, {0, 0, 0}, 64), b = radianceAt(mesh, {0, 0, 0}, 64);
        expectMean(a, 0.5 / pi * 1e6 * sphereIrradiance(light, {0, 0, 0}), 1e-3 * a.value);
        EXPECT_NEAR(a.value, b.value, 0.01 * a.value + 4 * b.sigma);
    }
}

TEST_F(LightTest, SunOfAnySizeGivesItsIrradianceTimesTheCosine) {
    for (const float radius : {1e-5f, 0.00465f, 0.1f, 0.6f}) {
        SCOPED_TRACE(radius);
        Scene scene;
        addFloor(scene);
        scene.lights = {sunLight({1, -1, 0}, radius, 3)};
        expectIrradiance(scene, {0, 0, 0}, 3 / std::sqrt(2.0));
    }
}

TEST_F(LightTest, SunShowsItsDiskToTheCameraWithItsRadiance) {
    Scene scene;
    scene.materials.push_back(matte(glm::vec3(1)));
    scene.lights = {sunLight({0, 0, -1}, 0.00465f, 2)};
    const double radiance = 2 / (pi * std::pow(std::sin(0.00465), 2));
    const auto seen = [&](double angle) {
        const Camera camera = cameraAt({0, 0, 0}, {std::sin(angle), 0, std::cos(angle)}, 1e-5);
        return meanOf(renderFrame(device, scene, camera, square(8), bounces(1), 1)).value;
    };
    EXPECT_NEAR(seen(0), radiance, 1e-5 * radiance);
    EXPECT_NEAR(seen(0.0046), radiance, 1e-5 * radiance);
    EXPECT_EQ(seen(0.0047), 0);
}

TEST_F(LightTest, RotationTurnsTheEnvironmentCounterClockwiseSeenFromAbove) {
    // A bright texel towards +x; turned by 90° it is towards −z.
    Scene scene;
    scene.materials.push_back(matte(glm::vec3(1)));
    scene.environment = oneTexelSun(4, 2, 2, 0, 5);  // its middle at 45° up, between +x and +z
    const auto seen = [&](double azimuth) {
        const glm::dvec3 d(std::cos(azimuth), 1, std::sin(azimuth));
        return meanOf(renderFrame(device, scene, cameraAt({0, 0, 0}, d, 1e-5), square(8), bounces(1), 1))
            .value;
    };
    EXPECT_NEAR(seen(pi / 4), 5, 1e-3);
    EXPECT_NEAR(seen(-pi / 4), 0, 1e-3);
    scene.environment.rotation = pi / 2;
    EXPECT_NEAR(seen(-pi / 4), 5, 1e-3);
    EXPECT_NEAR(seen(pi / 4), 0, 1e-3);
    scene.environment.rotation = -3.5 * pi;
    EXPECT_NEAR(seen(-pi / 4), 5, 1e-3);
}

TEST_F(LightTest, RotatingTheEnvironmentIsRotatingTheScene) {
    Scene scene;
    addFloor(scene);
    scene.environment = oneTexelSun(32, 16, 20, 4, 50);
    const Mean still = radianceAt(scene, {0, 0, 0}, 256);
    scene.environment.rotation = 2.2;  // the floor is round enough
    expectSame(still, radianceAt(scene, {0, 0, 0}, 256));
}

TEST_F(LightTest, HiddenEnvironmentLightsAndReflectsButIsNotSeen) {
    Scene scene;
    addFloor(scene, 1);
    Material mirror = matte(glm::vec3(1));
    mirror.metallic = 1;
    mirror.roughness = 0;
    addMesh(scene, quadMesh({-4, 0, 1}, {2, 0, 0}, {0, 0, -2}), mirror);
    scene.environment = uniformEnvironment(glm::vec3(2));
    scene.lights = {sunLight({0.3f, -1, 0}, 0.02f)};
    scene.environment.visible = false;
    const auto look = [&](const glm::dvec3& eye, const glm::dvec3& at) {
        return renderFrame(device, scene, cameraAt(eye, at, 1e-3), square(8), bounces(2), 64);
    };
    for (const glm::dvec3& up : {glm::dvec3(-0.3, 1, 0), glm::dvec3(1, 1, 0)}) {
        const auto sky = look({0, 1, 0}, glm::dvec3(0, 1, 0) + up);
        EXPECT_EQ(meanOf(sky).value, 0);
        EXPECT_EQ(sky[0].alpha, 0);
    }
    EXPECT_NEAR(meanOf(look({-3, 2, 0}, {-3, 0, 0.5})).value, 2, 1e-3) << "in the mirror";
    EXPECT_GT(meanOf(look({0, 2, 0}, {0, 0, 0})).value, 0.9) << "on the floor";
}

class EstimatorTest : public LightTest, public testing::WithParamInterface<size_t> {};

TEST_P(EstimatorTest, LightSamplingBsdfSamplingAndBothGiveTheSame) {
    LightScene light = lightsWithExtent()[GetParam()];
    // Half matte, half glossy, so that neither way of sampling has it easy.
    Material material = matte(glm::vec3(0.9f, 0.7f, 0.4f));
    material.metallic = 0.5f;
    material.roughness = 0.6f;
    Scene scene = light.scene;
    addMesh(scene, quadMesh({-5, 0, 6}, {10, 0, 0}, {0, 0, -10}), material);
    const uint32_t samples = light.cosCone > 0.98 ? 2048 : 256;
    const Mean mis = radianceAt(scene, light.point, 256, DirectLight::mis, LightSelection::power, 1),
               lights = radianceAt(scene, light.point, 256, DirectLight::lights, LightSelection::power, 2),
               bsdf = radianceAt(scene, light.point, samples, DirectLight::bsdf, LightSelection::power, 3);
    EXPECT_GT(mis.value, 0);
    expectSame(mis, lights);
    expectSame(mis, bsdf);
    expectSame(lights, bsdf);
}

INSTANTIATE_TEST_SUITE_P(Every, EstimatorTest, testing::Range(size_t{0}, lightsWithExtent().size()),
                         nameOfLight);

TEST_F(LightTest, SunAndSkyGiveTheSameToEveryEstimator) {
    Scene scene;
    addFloor(scene);
    SkySettings settings;
    settings.turbidity = 2;
    settings.sunAngularDiameter = 10;  // so that the BSDF finds it
    addSky(scene, settings, 1, 0.7);
    const Mean mis = radianceAt(scene, {0, 0, 0}, 64, DirectLight::mis, LightSelection::tree, 1),
               lights = radianceAt(scene, {0, 0, 0}, 64, DirectLight::lights, LightSelection::power, 2),
               bsdf = radianceAt(scene, {0, 0, 0}, 512, DirectLight::bsdf, LightSelection::power, 3);
    expectSame(mis, lights);
    expectSame(mis, bsdf);
    expectSame(lights, bsdf);
}

TEST_F(LightTest, BsdfSamplingAloneLeavesDeltaLightsToLightSampling) {
    Scene scene;
    addFloor(scene);
    PunctualLight lamp;
    lamp.position = {0, 2, 0};
    lamp.color = glm::vec3(3);
    scene.lights = {lamp};
    EXPECT_NEAR(radianceAt(scene, {0, 0, 0}, 4, DirectLight::bsdf).value, 0.5 / pi * 3 / 4, 1e-4);
}

}  // namespace
}  // namespace tilefarm
