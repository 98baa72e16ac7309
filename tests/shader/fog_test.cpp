// Fog against closed forms and quadrature in double precision, and its estimators against each other.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "shaders/gpu_types.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/light_scenes.h"
#include "tests/shader/render_frame.h"
#include "tests/support/test_scenes.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class FogTest : public DeviceTest {
protected:
    std::vector<FilmPixel> frame(const Scene& scene, const Camera& camera, uint32_t bounceCount,
                                 uint32_t samples, uint32_t size = 8) {
        return renderFrame(device, scene, camera, square(size), bounces(bounceCount), samples);
    }
};

Fog fogOf(const glm::dvec3& extinction, const glm::dvec3& albedo, double g = 0) {
    Fog fog;
    fog.extinction = extinction;
    fog.albedo = albedo;
    fog.anisotropy = g;
    return fog;
}

Fog within(Fog fog, const glm::dvec3& lower, const glm::dvec3& upper) {
    fog.box = Fog::Box{lower, upper};
    return fog;
}

/// Sees one direction, as far as a picture can.
Camera narrow(const glm::dvec3& eye, const glm::dvec3& target) {
    return cameraAt(eye, target, 1e-4);
}

double henyeyGreenstein(double g, double cosTheta) {
    return (1 - g * g) / (4 * pi * std::pow(1 + g * g - 2 * g * cosTheta, 1.5));
}

/// Simpson's rule.
double integral(double from, double to, const std::function<double(double)>& f) {
    constexpr int n = 4000;
    const double step = (to - from) / n;
    double sum = f(from) + f(to);
    for (int i = 1; i < n; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(from + i * step);
    return sum * step / 3;
}

/// A point lamp of 1 W/sr.
PunctualLight lampAt(const glm::dvec3& position, float intensity = 1) {
    PunctualLight lamp;
    lamp.position = position;
    lamp.color = glm::vec3(intensity);
    return lamp;
}

const glm::dvec3 kBlack{0}, kWhite{1};

// ---- absorption

TEST_F(FogTest, AnEmitterBehindAbsorbingFogIsDimmedByBeerLambertWithoutNoise) {
    const glm::dvec3 sigma{0.1, 0.5, 2};
    for (const bool whole : {true, false}) {
        Scene scene;
        addMesh(scene, quadMesh({-1, -1, -5}, {2, 0, 0}, {0, 2, 0}), matte(glm::vec3(0), glm::vec3(1, 2, 3)));
        scene.fog = fogOf(sigma, kBlack);
        // Without a box it fills the way from the camera to the surface.
        if (!whole) scene.fog = within(scene.fog, {-3, -3, -4}, {3, 3, -2.5});
        for (const FilmPixel& pixel : frame(scene, narrow({0, 0, 0}, {0, 0, -5}), 4, 16))
            for (size_t c = 0; c < 3; ++c) {
                const double expected = (double(c) + 1) * std::exp(-sigma[int(c)] * (whole ? 5 : 1.5));
                EXPECT_NEAR(pixel.mean[c], expected, 3e-6 * expected);
                EXPECT_LT(pixel.varianceOfMean(int(c)), 1e-10 * expected * expected);
            }
    }
}

TEST_F(FogTest, BeyondItsBoxTheEnvironmentIsAsItWas) {
    Scene scene;
    scene.environment = uniformEnvironment(glm::vec3(1));
    scene.fog = within(fogOf({0.7, 0, 0.1}, kBlack), {-1, -1, -2}, {1, 1, 0});
    const auto through = frame(scene, narrow({0, 0, 7}, {0, 0, 0}), 4, 4);
    const auto past = frame(scene, narrow({0, 0, 7}, {4, 0, 0}), 4, 4);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(meanOf(through, c).value, std::exp(-2 * scene.fog.extinction[c]), 1e-5);
        EXPECT_FLOAT_EQ(float(meanOf(past, c).value), 1);
    }
}

TEST_F(FogTest, LightIsDimmedOnItsWayToASurface) {
    const glm::dvec3 sigma{0.3, 0.9, 0};
    const double albedo = 0.6, height = 0.5;  // of the fog above the floor
    const glm::dvec3 eye{0.5, 4, 0}, toEye = glm::normalize(eye);
    const auto floorUnder = [&](const std::function<void(Scene&)>& light) {
        Scene scene;
        addMesh(scene, quadMesh({-9, 0, 9}, {18, 0, 0}, {0, 0, -18}), matte(glm::vec3(float(albedo))));
        scene.fog = within(fogOf(sigma, kBlack), {-1e4, -1, -1e4}, {1e4, height, 1e4});
        light(scene);
        return frame(scene, narrow(eye, {0, 0, 0}), 1, 256);
    };
    const auto expectFloor = [&](const std::vector<FilmPixel>& seen, const char* what,
                                 const std::function<double(double)>& irradiance) {
        SCOPED_TRACE(what);
        for (int c = 0; c < 3; ++c) {
            const double outgoing =
                albedo / pi * irradiance(sigma[c]) * std::exp(-sigma[c] * height / toEye.y);
            expectMean(meanOf(seen, c), outgoing, 2e-5 * outgoing);
        }
    };
    const glm::dvec3 lamp{-1, 2, 0.5}, in{-0.1, 0.3, 0.2};
    expectFloor(floorUnder([&](Scene& s) { s.lights = {lampAt(lamp)}; }), "lamp above the fog",
                [&](double k) {
                    const double cosine = lamp.y / glm::length(lamp);
                    return cosine / glm::dot(lamp, lamp) * std::exp(-k * height / cosine);
                });
    expectFloor(floorUnder([&](Scene& s) { s.lights = {lampAt(in)}; }), "lamp in the fog", [&](double k) {
        return in.y / std::pow(glm::length(in), 3) * std::exp(-k * glm::length(in));
    });
    const glm::vec3 down = glm::normalize(glm::vec3(1, -2, 0.3f));
    for (const float angle : {0.f, 0.005f})
        expectFloor(floorUnder([&](Scene& s) { s.lights = {sunLight(down, angle)}; }), "sun",
                    [&](double k) { return -double{down.y} * std::exp(k * height / double{down.y}); });
    expectFloor(floorUnder([&](Scene& s) { s.environment = uniformEnvironment(glm::vec3(1)); }),
                "environment", [&](double k) {
                    return integral(0, 1, [&](double mu) {
                        return mu > 0 ? 2 * pi * mu * std::exp(-k * height / mu) : 0;
                    });
                });
}

TEST_F(FogTest, ThereIsNoneInsideOfSolids) {
    Material slab;
    slab.metallic = 0;
    slab.roughness = 0;
    slab.ior = 1;
    slab.transmission = 1;
    slab.thickness = 1;
    slab.attenuationColor = {0.5f, 1, 1};
    slab.attenuationDistance = 2;
    Scene scene;
    addMesh(scene, cubeMesh(false), slab, glm::scale(glm::dmat4(1), glm::dvec3(10, 10, 1)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    scene.fog = within(fogOf({0.4, 0.3, 0}, kBlack), {-2, -2, -3}, {2, 2, 2});
    const auto seen = frame(scene, narrow({0, 0, 9}, {0, 0, 0}), 8, 16);
    EXPECT_NEAR(meanOf(seen, 0).value, 0.5 * std::exp(-0.4 * 3), 1e-5);
    EXPECT_NEAR(meanOf(seen, 1).value, std::exp(-0.3 * 3), 1e-5);
    EXPECT_NEAR(meanOf(seen, 2).value, 1, 1e-5);
}

// ---- single scattering

TEST_F(FogTest, LightScatteredOnceEqualsQuadrature) {
    const glm::dvec3 extinction{0.2, 0.6, 1.5}, albedo{0.9, 0.5, 0.8}, lamp{0.4, 0.6, -0.3};
    const glm::vec3 beam = glm::normalize(glm::vec3(0.3f, -1, 0.2f));
    const glm::dvec3 eye{0.1, 0, 5}, along = glm::normalize(glm::dvec3(0.1, -0.05, -1)),
                                     toSun = -glm::dvec3(beam);
    // Where the camera's ray crosses the box of half side 1.
    const double from = (eye.z - 1) / -along.z, to = (eye.z + 1) / -along.z;
    for (const double g : {0., 0.7, -0.5}) {
        SCOPED_TRACE(g);
        Scene scene;
        scene.fog = within(fogOf(extinction, albedo, g), glm::dvec3(-1), glm::dvec3(1));
        Scene sunny = scene;
        scene.lights = {lampAt(lamp)};
        sunny.lights = {sunLight(beam, 0)};
        const auto ofLamp = frame(scene, narrow(eye, eye + along), 1, 2048, 16);
        const auto ofSun = frame(sunny, narrow(eye, eye + along), 1, 2048, 16);
        for (int c = 0; c < 3; ++c) {
            const double k = extinction[c], scattering = k * albedo[c];
            const auto once = [&](const std::function<double(const glm::dvec3&)>& arriving) {
                return integral(from, to, [&](double t) {
                    return scattering * std::exp(-k * (t - from)) * arriving(eye + t * along);
                });
            };
            expectMean(meanOf(ofLamp, c), once([&](const glm::dvec3& p) {
                           const glm::dvec3 d = lamp - p;
                           const double r = glm::length(d);
                           return henyeyGreenstein(g, glm::dot(along, d / r)) / (r * r) * std::exp(-k * r);
                       }));
            expectMean(meanOf(ofSun, c), once([&](const glm::dvec3& p) {
                           double out = 1e9;
                           for (int a = 0; a < 3; ++a)
                               out = std::min(out, ((toSun[a] > 0 ? 1 : -1) - p[a]) / toSun[a]);
                           return henyeyGreenstein(g, glm::dot(along, toSun)) * std::exp(-k * out);
                       }));
        }
    }
}

// ---- energy

TEST_F(FogTest, WhiteFogUnderUniformSkyIsInvisible) {
    for (const double g : {0., 0.9, -0.9})
        for (const glm::dvec3& extinction :
             {glm::dvec3(1e-9), glm::dvec3(0.5), glm::dvec3(4), glm::dvec3(0.2, 1, 4)}) {
            SCOPED_TRACE(testing::Message()
                         << "g " << g << " extinction " << extinction.x << " " << extinction.z);
            Scene scene;
            addMesh(scene, sphereMesh(12), matte(glm::vec3(1)), glm::scale(glm::dmat4(1), glm::dvec3(0.3)));
            scene.environment = uniformEnvironment(glm::vec3(1));
            scene.fog = within(fogOf(extinction, kWhite, g), glm::dvec3(-1), glm::dvec3(1));
            const auto seen = frame(scene, cameraAt({2, 1, 3}, {0, 0, 0}, 0.3), 1000, 32, 16);
            for (int c = 0; c < 3; ++c) expectMean(meanOf(seen, c), 1, 1e-4);
        }
}

// ---- estimators

/// Fog over a floor, with every kind of light and a mirror.
Scene foggyRoom() {
    Scene scene;
    addMesh(scene, quadMesh({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), matte({0.7f, 0.5f, 0.3f}));
    Material mirror;
    mirror.roughness = 0.2f;
    addMesh(scene, sphereMesh(12), mirror,
            glm::translate(glm::dmat4(1), {-0.5, 0.5, 0}) * glm::scale(glm::dmat4(1), glm::dvec3(0.4)));
    addMesh(scene, quadMesh({1, 1, -1}, {0.5f, 0, 0}, {0, 0, 0.4f}), matte(glm::vec3(0), glm::vec3(6)));
    scene.areaLights = {quadLight({-1, 1.5, 0.5}, {0.2, 0, 0}, {0, 0, 0.3}, 8),
                        sphereLight({0.3, 0.5, -0.6}, 0.15, 6)};
    scene.environment = oneTexelSun(16, 8, 9, 2, 3);
    scene.lights = {sunLight({-1, -2, 0.3f}, 0.1f, 0.6f)};
    scene.fog = fogOf({0.3, 0.5, 0.9}, {0.9, 0.8, 0.95}, 0.6);
    return scene;
}

TEST_F(FogTest, LightsAloneAndThePhaseFunctionAloneAgreeWithBoth) {
    const Scene scene = foggyRoom();
    const Camera camera = cameraAt({0.5, 1.2, 3}, {0, 0.5, 0}, 0.8);
    const auto seen = [&](DirectLight how, uint32_t samples) {
        RenderSettings settings = bounces(6, 1 + static_cast<uint32_t>(how));
        settings.directLight = how;
        return renderFrame(device, scene, camera, square(16), settings, samples);
    };
    const auto mis = seen(DirectLight::mis, 256), lights = seen(DirectLight::lights, 512),
               found = seen(DirectLight::bsdf, 1024);
    for (int c = 0; c < 3; ++c) {
        expectSame(meanOf(mis, c), meanOf(lights, c));
        expectSame(meanOf(mis, c), meanOf(found, c));
    }
}

TEST_F(FogTest, FullEveryWayOfChoosingLightsGivesTheSamePicture) {
    Scene scene = foggyRoom();
    scene.lights.push_back(lampAt({0.2, 0.4, 0.8}, 0.3f));
    scene.lights.push_back(lampAt({-1.2, 0.6, 0.4}, 0.3f));
    const Camera camera = cameraAt({0.5, 1.2, 3}, {0, 0.5, 0}, 0.8);
    const auto seen = [&](LightSelection how, uint32_t samples) {
        RenderSettings settings = bounces(4, 1 + static_cast<uint32_t>(how));
        settings.lightSelection = how;
        return meanOf(renderFrame(device, scene, camera, square(16), settings, samples));
    };
    const Mean all = seen(LightSelection::all, 64);
    expectSame(all, seen(LightSelection::power, 256));
    expectSame(all, seen(LightSelection::tree, 256));
}

// ---- what must not change, and extremes

bool sameBits(const std::vector<FilmPixel>& a, const std::vector<FilmPixel>& b) {
    for (size_t i = 0; i < a.size(); ++i)
        if (a[i].mean != b[i].mean || a[i].depth != b[i].depth || a[i].normal != b[i].normal) return false;
    return a.size() == b.size();
}

TEST_F(FogTest, OfNoExtinctionChangesNoBit) {
    Scene scene = foggyRoom();
    const Camera camera = cameraAt({0.5, 1.2, 3}, {0, 0.5, 0}, 0.8);
    scene.fog.extinction = glm::dvec3(0);
    scene.fog.box = Fog::Box{glm::dvec3(-1), glm::dvec3(1)};
    const auto none = frame(scene, camera, 5, 8, 16);
    scene.fog = {};
    EXPECT_TRUE(sameBits(none, frame(scene, camera, 5, 8, 16)));
}

TEST_F(FogTest, LeavesTheChannelsOfTheFirstSurfaceAlone) {
    Scene scene = foggyRoom();
    const Camera camera = cameraAt({0.5, 1.2, 3}, {0, 0.5, 0}, 0.8);
    const auto foggy = frame(scene, camera, 3, 4, 16);
    scene.fog = {};
    const auto clear = frame(scene, camera, 3, 4, 16);
    for (size_t i = 0; i < clear.size(); ++i) {
        EXPECT_EQ(foggy[i].depth, clear[i].depth);
        EXPECT_EQ(foggy[i].alpha, clear[i].alpha);
        EXPECT_EQ(foggy[i].normal, clear[i].normal);
        EXPECT_EQ(foggy[i].albedo, clear[i].albedo);
    }
}

TEST_F(FogTest, OfAnyDensityIsFiniteFromAnywhere) {
    Scene scene = foggyRoom();
    const auto cameraAtZ = [](double z) { return cameraAt({0, 0.5, z}, {0, 0.5, 0}, 0.8); };
    Renderer renderer(device, scene, cameraAtZ(3), square(8), bounces(32));
    for (const glm::dvec3& extinction :
         {glm::dvec3(1e6), glm::dvec3(1e-9), glm::dvec3(1e6, 0, 1e-9), glm::dvec3(1e9, 1, 0)})
        for (const double g : {0., 0.9999, -0.9999}) {
            scene.fog = within(fogOf(extinction, {1, 0.5, 0.9}, g), glm::dvec3(-1), glm::dvec3(1));
            renderer.setScenes(1, [&](uint32_t) -> const Scene& { return scene; });
            for (const double z : {3., 0.2, 1.}) {  // outside of the box, inside, on its face
                renderer.setCamera({{cameraAtZ(z)}, std::nullopt});
                const auto films = renderer.render(0, allTiles(square(8)), {0, 2});
                for (const PassPixel& pixel : films.front().pixels)
                    for (size_t c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(pixel.mean[c]));
            }
        }
    EXPECT_EQ(renderer.stats().droppedSamples, 0u);
}

TEST_F(FogTest, ScatteringsStandInTheTraceOfASample) {
    Scene scene;
    scene.environment = uniformEnvironment(glm::vec3(1));
    scene.fog = within(fogOf(glm::dvec3(3), kWhite), glm::dvec3(-1), glm::dvec3(1));
    Renderer renderer(device, scene, narrow({0, 0, 5}, {0, 0, 0}), square(8), bounces(32), {},
                      gpu::bit(gpu::FEATURE_TRACE));
    const SampleTrace trace = renderer.trace(0, 4, 4, 0);
    ASSERT_GE(trace.steps.size(), 2u);
    for (size_t i = 0; i + 1 < trace.steps.size(); ++i) {
        EXPECT_EQ(trace.steps[i].primitive, kNone);
        EXPECT_GT(trace.steps[i].t, 0);
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(trace.steps[i].position[axis]), 1.00001);
    }
    EXPECT_TRUE(std::isinf(trace.steps.back().t));
}

}  // namespace
}  // namespace tilefarm
