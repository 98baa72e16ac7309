// The integrators that do not trace paths, against closed forms and values of the host.
#include <gtest/gtest.h>

#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>

#include "shaders/gpu_types.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/render_frame.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_scenes.h"
#include "worker/agent/device_backend.h"

namespace tilefarm {
namespace {

class IntegratorTest : public DeviceTest {};

RenderSettings with(Integrator integrator, uint32_t maxBounces = 8, bool jitter = true) {
    RenderSettings settings = bounces(maxBounces);
    settings.integrator = integrator;
    settings.jitter = jitter;
    return settings;
}

Camera orthographic(const glm::dvec3& eye, const glm::dvec3& target, float halfHeight) {
    Camera camera = cameraAt(eye, target, 1);
    camera.orthographic = true;
    camera.ymag = halfHeight;
    return camera;
}

/// Origin of the ray through a pixel's centre of a square image.
glm::dvec3 rayOrigin(const Camera& camera, uint32_t size, uint32_t x, uint32_t y) {
    const double s = 2 * (x + 0.5) / size - 1, t = 1 - 2 * (y + 0.5) / size;
    return glm::dvec3(camera.toWorld * glm::dvec4(s * camera.ymag, t * camera.ymag, 0, 1));
}

/// y = `height`, facing up.
Mesh floorMesh(float half, float height = 0) {
    return quadMesh({-half, height, half}, {2 * half, 0, 0}, {0, 0, -2 * half});
}

Material mirror(float reflectance, float emission) {
    Material m = matte(glm::vec3(reflectance), glm::vec3(emission));
    m.metallic = 1;
    m.roughness = 0;
    return m;
}

Material glass(float ior) {
    Material m = matte(glm::vec3(1));
    m.ior = ior;
    m.roughness = 0;
    m.transmission = 1;
    m.thickness = 1;
    return m;
}

// ---- Ambient occlusion

TEST_F(IntegratorTest, OpenPlaneIsNotOccluded) {
    Scene scene;
    addMesh(scene, floorMesh(1), matte(glm::vec3(0.3f)));
    const auto frame = renderFrame(device, scene, orthographic({0, 1, 0}, {0, 0, 0}, 0.5f), square(16),
                                   with(Integrator::ambientOcclusion), 16);
    for (const FilmPixel& pixel : frame) EXPECT_EQ(pixel.mean[0], 1);
}

TEST_F(IntegratorTest, CeilingOccludesTheConeWithinReach) {
    Scene scene;
    addMesh(scene, floorMesh(100), matte(glm::vec3(0.3f)));
    addMesh(scene, floorMesh(100, 1), matte(glm::vec3(0.3f)));
    const Camera camera = orthographic({0, 0.5, 0}, {0, 0, 0}, 0.5f);
    RenderSettings settings = with(Integrator::ambientOcclusion);
    // Directions with cosθ > height / reach meet it: a share 1 − (height / reach)² of the cosine-weighted
    // whole.
    for (const double reach : {1.25, 2.0, 4.0}) {
        settings.aoDistance = reach;
        expectMean(meanOf(renderFrame(device, scene, camera, square(32), settings, 64)), 1 / (reach * reach));
    }
    settings.aoDistance = 0.99;
    for (const FilmPixel& pixel : renderFrame(device, scene, camera, square(16), settings, 4))
        EXPECT_EQ(pixel.mean[0], 1);
}

TEST_F(IntegratorTest, WallHidesHalfOfWhatTheFloorSees) {
    Scene scene;
    addMesh(scene, floorMesh(10), matte(glm::vec3(0.3f)));
    addMesh(scene, quadMesh({0, 0, 1e5f}, {0, 0, -2e5f}, {0, 1e5f, 0}), matte(glm::vec3(0.3f)));
    RenderSettings settings = with(Integrator::ambientOcclusion);
    settings.aoDistance = 1e6;
    const auto frame =
        renderFrame(device, scene, orthographic({2, 1, 0}, {2, 0, 0}, 1), square(32), settings, 64);
    expectMean(meanOf(frame), 0.5, 1e-4);
}

// ---- Views

TEST_F(IntegratorTest, ViewsShowWhatTheFirstSurfaceIs) {
    // A slope seen from above; the second quad lies below it and is not seen.
    const glm::dvec3 normal = glm::normalize(glm::dvec3(-1, 2, 0));
    const glm::vec3 albedo(0.2f, 0.5f, 0.7f);
    Scene scene;
    addMesh(scene, quadMesh({-1, -0.5f, 1}, {2, 1, 0}, {0, 0, -2}), matte(albedo, glm::vec3(3)));
    addMesh(scene, floorMesh(5, -1), matte(glm::vec3(0.9f)));
    constexpr uint32_t kSize = 8;
    const Camera camera = orthographic({0, 3, 0}, {0, 0, 0}, 0.9f);
    const auto seen = [&](Integrator view) {
        return renderFrame(device, scene, camera, square(kSize), with(view, 8, false), 2);
    };
    const auto normals = seen(Integrator::normal), flat = seen(Integrator::geometricNormal),
               depths = seen(Integrator::depth), uvs = seen(Integrator::uv),
               albedos = seen(Integrator::albedo);
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = 0; x < kSize; ++x) {
            const size_t i = y * kSize + x;
            const glm::dvec3 p = rayOrigin(camera, kSize, x, y);
            const double height = 0.5 * p.x;
            EXPECT_NEAR(depths[i].mean[0], 3 - height, 1e-5);
            EXPECT_NEAR(uvs[i].mean[0], (p.x + 1) / 2, 1e-5);
            EXPECT_NEAR(uvs[i].mean[1], (1 - p.z) / 2, 1e-5);
            EXPECT_EQ(uvs[i].mean[2], 0);
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(normals[i].mean[static_cast<size_t>(c)], 0.5 + 0.5 * normal[c], 1e-6);
                EXPECT_NEAR(flat[i].mean[static_cast<size_t>(c)], 0.5 + 0.5 * normal[c], 1e-6);
                EXPECT_EQ(albedos[i].mean[static_cast<size_t>(c)], albedo[c]);
            }
        }
}

TEST_F(IntegratorTest, MaterialsAndObjectsAreToldApart) {
    Scene scene;
    for (int i = 0; i < 16; ++i) {
        addMesh(scene, quadMesh({float(i % 4), float(i / 4), 0}, {1, 0, 0}, {0, 1, 0}),
                matte(glm::vec3(0.5f)));
        scene.instances.back().node = "node " + std::to_string(i);
    }
    for (const Integrator view : {Integrator::material, Integrator::object}) {
        const auto frame = renderFrame(device, scene, orthographic({2, 2, 1}, {2, 2, 0}, 2), square(4),
                                       with(view, 8, false), 1);
        for (size_t i = 0; i < frame.size(); ++i)
            for (size_t j = 0; j < i; ++j) {
                double most = 0;
                for (size_t c = 0; c < 3; ++c)
                    most = std::max(most, std::abs(frame[i].mean[c] - frame[j].mean[c]));
                EXPECT_GT(most, 0.02) << i << ", " << j;
            }
    }
}

// ---- Whitted

TEST_F(IntegratorTest, MirrorsFacingEachOtherReflectUpToTheDepth) {
    Scene scene;
    const Material plate = mirror(0.8f, 1);
    addMesh(scene, quadMesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), plate);
    addMesh(scene, quadMesh({1, -1, 1}, {-2, 0, 0}, {0, 2, 0}), plate);
    const Camera camera = orthographic({0, 0, 0.5}, {0, 0, 0}, 0.5f);
    for (const Integrator integrator : {Integrator::whitted, Integrator::path})
        for (const uint32_t depth : {0u, 1u, 4u, 10u, 25u}) {
            RenderSettings settings = with(integrator, depth);
            settings.roulette = RouletteRule::none;
            const auto frame = renderFrame(device, scene, camera, square(8), settings, 1);
            double expected = 0;
            for (uint32_t i = 0; i <= depth; ++i) expected += std::pow(0.8, i);
            for (const FilmPixel& pixel : frame)
                EXPECT_NEAR(pixel.mean[1], expected, 2e-5 * expected) << depth;
        }
}

double fresnel(double cosTheta, double eta) {
    const double cosT = std::sqrt(1 - (1 - cosTheta * cosTheta) / (eta * eta));
    const double a = (eta * cosTheta - cosT) / (eta * cosTheta + cosT),
                 b = (cosTheta - eta * cosT) / (cosTheta + eta * cosT);
    return (a * a + b * b) / 2;
}

TEST_F(IntegratorTest, SlabOfGlassShiftsWhatLiesBehind) {
    constexpr double kEta = 1.5, kAngle = 0.8, kThickness = 1;
    Scene scene;
    addMesh(scene, floorMesh(20, 1), glass(kEta));
    addMesh(scene, quadMesh({-20, 0, -20}, {40, 0, 0}, {0, 0, 40}), glass(kEta));  // facing down
    addMesh(scene, quadMesh({-20, -1, 20}, {20, 0, 0}, {0, 0, -40}), matte(glm::vec3(0), glm::vec3(1)));
    addMesh(scene, quadMesh({0, -1, 20}, {20, 0, 0}, {0, 0, -40}), matte(glm::vec3(0)));
    constexpr uint32_t kSize = 32;
    const glm::dvec3 forward(std::sin(kAngle), -std::cos(kAngle), 0);
    const Camera camera = orthographic(-5.0 * forward, glm::dvec3(0), 2);
    // Two scatterings: through both sides, without what is reflected between them.
    const auto frame =
        renderFrame(device, scene, camera, square(kSize), with(Integrator::whitted, 2, false), 1);
    const double inside = std::asin(std::sin(kAngle) / kEta);
    const double f = fresnel(std::cos(kAngle), kEta);
    size_t lit = 0;
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = 0; x < kSize; ++x) {
            const glm::dvec3 o = rayOrigin(camera, kSize, x, y);
            const double onTop = o.x + (o.y - 1) * std::tan(kAngle);
            const double below = onTop + kThickness * std::tan(inside) + std::tan(kAngle);
            if (std::abs(below) < 1e-3) continue;
            lit += below < 0;
            EXPECT_NEAR(frame[y * kSize + x].mean[0], below < 0 ? (1 - f) * (1 - f) : 0, 1e-5)
                << x << ", " << y;
        }
    EXPECT_GT(lit, 100u);
    EXPECT_LT(lit, size_t{kSize * kSize - 100});
}

TEST_F(IntegratorTest, ShadowsAreHardAndLightsShineFromTheirMiddle) {
    constexpr uint32_t kSize = 32;
    const Camera camera = orthographic({0.5, 0.5, 0}, {0.5, 0, 0}, 2);
    PunctualLight point;
    point.position = {0, 2, 0};
    point.color = glm::vec3(5);
    AreaLight square_;
    square_.position = {0, 2, 0};
    square_.u = {0.3, 0, 0};
    square_.v = {0, 0, 0.3};
    AreaLight ball;
    ball.shape = AreaShape::sphere;
    ball.position = {0, 2, 0};
    ball.radius = 0.3;
    for (int kind = 0; kind < 3; ++kind) {
        Scene scene;
        addMesh(scene, floorMesh(20), matte(glm::vec3(0.5f)));
        addMesh(scene, quadMesh({0.25f, 1, 9}, {9, 0, 0}, {0, 0, -18}), matte(glm::vec3(0.5f)));
        if (kind == 0) scene.lights.push_back(point);
        if (kind == 1) scene.areaLights.push_back(square_);
        if (kind == 2) scene.areaLights.push_back(ball);
        const auto frame = renderFrame(device, scene, camera, tilefarm::square(kSize),
                                       with(Integrator::whitted, 1, false), 1);
        for (uint32_t y = 0; y < kSize; ++y)
            for (uint32_t x = 0; x < kSize; ++x) {
                const glm::dvec3 p = rayOrigin(camera, kSize, x, y);
                const double seen = frame[y * kSize + x].mean[0];
                const double squared = p.x * p.x + p.z * p.z + 4;
                if (std::abs(p.x - 0.5) < 1e-3) continue;
                EXPECT_EQ(seen > 0, p.x < 0.5) << kind << ": " << x << ", " << y;
                if (kind == 0 && p.x < 0.5) {
                    const double expected = 0.5 / std::numbers::pi * 5 * 2 / (squared * std::sqrt(squared));
                    EXPECT_NEAR(seen, expected, 1e-5 * expected);
                }
            }
    }
}

/// Radiance of a matte white ball by one integrator, pixel by pixel.
std::vector<FilmPixel> ballIn(const gpu::Device& device, const Environment& environment,
                              Integrator integrator, uint32_t samples) {
    Scene scene;
    addMesh(scene, sphereMesh(64), matte(glm::vec3(1)));
    scene.environment = environment;
    return renderFrame(device, scene, cameraAt({1, 2, 4}, {0, 0, 0}, 0.3), square(24),
                       with(integrator, 1, false), samples);
}

TEST_F(IntegratorTest, EvenEnvironmentLightsMatteSurfacesExactly) {
    for (const FilmPixel& pixel :
         ballIn(device, uniformEnvironment({0.5f, 0.5f, 0.5f}), Integrator::whitted, 1))
        EXPECT_NEAR(pixel.mean[0], 0.5, 1e-6);
}

TEST_F(IntegratorTest, IrradianceOfAnyEnvironmentIsWithinSomePercent) {
    Environment environment = uniformEnvironment(glm::vec3(0.2f), 32, 16);
    for (uint32_t y = 3; y < 8; ++y)  // a bright patch, and a coloured one elsewhere
        for (uint32_t x = 18; x < 24; ++x) environment.image.rgbaFloat[4 * (y * 32 + x)] = 5;
    for (uint32_t y = 1; y < 14; ++y)
        for (uint32_t x = 3; x < 9; ++x) environment.image.rgbaFloat[4 * (y * 32 + x) + 1] = 3;
    environment.rotation = 1;
    const auto whitted = ballIn(device, environment, Integrator::whitted, 1),
               path = ballIn(device, environment, Integrator::path, 1024);
    for (size_t channel = 0; channel < 2; ++channel) {
        double most = 0, worst = 0;
        for (size_t i = 0; i < path.size(); ++i) {
            if (!hit(path[i])) continue;
            most = std::max(most, path[i].mean[channel]);
            worst = std::max(worst, std::abs(path[i].mean[channel] - whitted[i].mean[channel]));
        }
        EXPECT_LT(worst, 0.09 * most) << channel;
        EXPECT_GT(most, 0.4) << channel;
    }
}

// ---- Raster

class RasterIntegratorTest : public DeviceTest {
protected:
    RasterIntegratorTest() : DeviceTest({.graphics = true}) {}
};

TEST_F(RasterIntegratorTest, LambertIsLitThroughWhateverIsInBetween) {
    constexpr uint32_t kSize = 32;
    const Camera camera = orthographic({0.5, 0.5, 0}, {0.5, 0, 0}, 2);
    Scene scene;
    addMesh(scene, floorMesh(20), matte(glm::vec3(0.5f)));
    addMesh(scene, floorMesh(20, 1), matte(glm::vec3(0.5f)));
    PunctualLight point;
    point.position = {0, 2, 0};
    point.color = glm::vec3(5);
    scene.lights.push_back(point);
    const auto frame =
        renderFrame(device, scene, camera, square(kSize), with(Integrator::raster, 1, false), 2);
    for (uint32_t y = 0; y < kSize; ++y)
        for (uint32_t x = 0; x < kSize; ++x) {
            const glm::dvec3 p = rayOrigin(camera, kSize, x, y);
            const double squared = p.x * p.x + p.z * p.z + 4;
            const double expected = 0.5 / std::numbers::pi * 5 * 2 / (squared * std::sqrt(squared));
            EXPECT_NEAR(frame[y * kSize + x].mean[0], expected, 1e-5 * expected) << x << ", " << y;
            EXPECT_NEAR(frame[y * kSize + x].depth, 0.5, 1e-6);
        }
}

TEST_F(RasterIntegratorTest, BlocksOfLargeImagesFitTogether) {
    Scene scene;
    addMesh(scene, sphereMesh(24), matte(glm::vec3(0.5f)));
    ImageSpec image;
    image.width = gpu::RASTER_BLOCK + 72;
    image.height = 16;
    image.tileSize = 136;  // one tile lies in both blocks
    Camera camera = orthographic({0, 0, 3}, {0, 0, 0}, 1.0f / 256);
    const auto drawn = renderFrame(device, scene, camera, image, with(Integrator::raster, 1, false), 1),
               cast = renderFrame(device, scene, camera, image, with(Integrator::normal, 1, false), 1);
    size_t other = 0, covered = 0;
    for (size_t i = 0; i < drawn.size(); ++i) {
        covered += hit(drawn[i]);
        other += drawn[i].normal != cast[i].normal;
    }
    EXPECT_LT(other, drawn.size() / 200);
    EXPECT_GT(covered, drawn.size() / 2);
}

TEST_F(RasterIntegratorTest, RefusesPanoramas) {
    Camera camera = cameraAt({0, 0, 3}, {0, 0, 0}, 1);
    camera.panorama = true;
    Scene scene;
    addMesh(scene, floorMesh(1), matte(glm::vec3(0.5f)));
    EXPECT_THAT(
        errorOf([&] { Renderer(device, scene, camera, square(16), with(Integrator::raster)); }).what(),
        testing::HasSubstr("panorama"));
}

// ---- All of them

struct Named {
    const char* name;
    Integrator integrator;
};
constexpr Named kAll[]{
    {"path", Integrator::path},     {"whitted", Integrator::whitted},
    {"raster", Integrator::raster}, {"ambientOcclusion", Integrator::ambientOcclusion},
    {"normal", Integrator::normal}, {"uv", Integrator::uv},
};

class EveryIntegrator : public testing::TestWithParam<Named> {
protected:
    JobSpec job(uint32_t tile) {
        JobSpec spec;
        spec.image = square(48, tile);
        spec.settings.integrator = GetParam().integrator;
        spec.settings.maxBounces = 4;
        return spec;
    }
    std::unique_ptr<RenderBackend> backend = makeDeviceBackend(gpu::defaultDevice());
};

const std::filesystem::path kData = std::filesystem::path(TILEFARM_SOURCE_DIR) / "tests/data";

TEST_P(EveryIntegrator, GivesFiniteValuesInEveryScene) {
    for (const char* name : {"shapes.gltf", "layers.glb"}) {
        const JobSpec spec = job(48);
        backend->prepare(spec, {kData / name, {}});
        const auto films = backend->render(0, std::vector<uint32_t>{0}, {0, 2});
        EXPECT_EQ(backend->stats().droppedSamples, 0u) << name;
        EXPECT_EQ(backend->stats().samples, 2u * 48 * 48) << name;
        double sum = 0;
        for (const PassPixel& pixel : films.front().pixels)
            sum += pixel.mean[0] + pixel.mean[1] + pixel.mean[2];
        EXPECT_TRUE(std::isfinite(sum)) << name;
        EXPECT_GT(sum, 0) << name;
    }
}

TEST_P(EveryIntegrator, TilesDoNotShow) {
    std::vector<PassPixel> whole;
    for (const uint32_t tile : {48u, 16u}) {
        const JobSpec spec = job(tile);
        backend->prepare(spec, {kData / "shapes.gltf", {}});
        const TileGrid grid(spec.image);
        for (uint32_t i = 0; i < grid.count(); ++i) {
            const auto films = backend->render(0, std::vector<uint32_t>{i}, {0, 2});
            if (tile == 48) {
                whole = films.front().pixels;
                continue;
            }
            const Rect rect = grid.rect(i);
            for (uint32_t y = 0; y < rect.height; ++y)
                EXPECT_EQ(
                    std::memcmp(&films.front().pixels[size_t{y} * rect.width],
                                &whole[size_t{rect.y + y} * 48 + rect.x], rect.width * sizeof(PassPixel)),
                    0)
                    << "tile " << i << ", row " << y;
        }
    }
}

/// Share of the pixels in which the film's normals differ.
double apart(const PassFilm& a, const PassFilm& b) {
    double other = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i)
        other += a.pixels[i].normal != b.pixels[i].normal || a.pixels[i].alpha != b.pixels[i].alpha;
    return other / static_cast<double>(a.pixels.size());
}

TEST(RasterScenes, ShowTheSurfacesThatRaysMeet) {
    const auto backend = makeDeviceBackend(gpu::defaultDevice());
    for (const ViewKind kind : {ViewKind::perspective, ViewKind::orthographic}) {
        JobSpec spec;
        spec.image = square(96);
        spec.settings.jitter = false;
        spec.view.kind = kind;
        spec.view.eye = {1, 2, 6};
        spec.view.height = 5;
        std::vector<PassFilm> films;
        for (const Integrator integrator : {Integrator::raster, Integrator::normal}) {
            spec.settings.integrator = integrator;
            backend->prepare(spec, {kData / "shapes.gltf", {}});
            films.push_back(backend->render(0, std::vector<uint32_t>{0}, {0, 1}).front());
        }
        // Only at edges may a pixel's centre fall to the one or the other.
        EXPECT_LT(apart(films[0], films[1]), 0.01) << static_cast<int>(kind);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, EveryIntegrator, testing::ValuesIn(kAll),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace tilefarm
