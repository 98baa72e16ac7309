// Channels that a job asks for beside the picture: light by its first scattering, texture coordinates,
// mattes.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "shaders/gpu_types.h"
#include "shared/matte/cryptomatte.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/render_frame.h"
#include "tests/support/test_scenes.h"
#include "worker/render/output_features.h"
#include "worker/render/renderer.h"

namespace tilefarm {
namespace {

constexpr FilmLayout kLight{.lightPaths = true};
constexpr FilmLayout kMatte{.cryptomatte = true};
constexpr FilmLayout kAll{.lightPaths = true, .uv = true, .cryptomatte = true};

struct View {
    Scene scene;
    Camera camera;
};

glm::dmat4 placed(const glm::dvec3& at, double size) {
    return glm::scale(glm::translate(glm::dmat4(1), at), glm::dvec3(size));
}

/// Sees the square of half side 1 around the origin from +z, along parallel rays.
Camera flatCamera() {
    Camera camera = cameraAt({0, 0, 2}, {0, 0, 0}, 1);
    camera.orthographic = true;
    camera.xmag = camera.ymag = 1;
    return camera;
}

Material smooth(float metallic, float transmission) {
    Material m = matte(glm::vec3(1));
    m.ior = 1.5f;
    m.metallic = metallic;
    m.roughness = 0;
    m.transmission = transmission;
    return m;
}

class ChannelsTest : public DeviceTest {
protected:
    ChannelsTest() : DeviceTest({.graphics = true}) {}  // for the raster integrator

    std::vector<FilmTile> render(const View& view, const FilmLayout& layout, const ImageSpec& image,
                                 const RenderSettings& settings, uint32_t samples, uint64_t features = 0) {
        Renderer renderer(device, view.scene, view.camera, image, settings, layout, features);
        const TileGrid grid(image);
        std::vector<FilmTile> tiles;
        for (uint32_t i = 0; i < grid.count(); ++i) tiles.emplace_back(grid.rect(i), layout);
        for (const SampleRange& range : passSchedule(samples))
            for (const PassFilm& film : renderer.render(0, allTiles(image), range))
                tiles[film.tile].merge(film);
        return tiles;
    }

    FilmTile renderTile(const View& view, const FilmLayout& layout, const RenderSettings& settings,
                        uint32_t samples, uint32_t size = 32) {
        return std::move(render(view, layout, square(size), settings, samples).front());
    }
};

// By LIGHT_PATH_*, rgb each.
double lightOf(const FilmTile& tile, size_t pixel, uint32_t path, uint32_t channel = 0) {
    return tile.extra[pixel * tile.layout.floats() + 3 * path + channel];
}

/// The mean of a way of light over the pixels that see a surface.
double meanLight(const FilmTile& tile, uint32_t path) {
    double sum = 0;
    int n = 0;
    for (size_t i = 0; i < tile.pixels.size(); ++i) {
        if (tile.pixels[i].alpha != 1) continue;
        sum += lightOf(tile, i, path);
        ++n;
    }
    return sum / n;
}

/// Expects light of no other ways than these.
void expectOnly(const FilmTile& tile, std::initializer_list<uint32_t> paths) {
    for (uint32_t path = 0; path < gpu::LIGHT_PATH_COUNT; ++path) {
        if (std::find(paths.begin(), paths.end(), path) != paths.end()) continue;
        for (size_t i = 0; i < tile.pixels.size(); ++i) ASSERT_EQ(lightOf(tile, i, path), 0) << path;
    }
}

// ---- Light adds up

void expectSums(const std::vector<FilmTile>& tiles) {
    double worst = 0;
    size_t lit = 0;
    for (const FilmTile& tile : tiles)
        for (size_t i = 0; i < tile.pixels.size(); ++i)
            for (uint32_t c = 0; c < 3; ++c) {
                double sum = 0;
                for (uint32_t path = 0; path < gpu::LIGHT_PATH_COUNT; ++path) {
                    ASSERT_GE(lightOf(tile, i, path, c), 0);
                    sum += lightOf(tile, i, path, c);
                }
                const double whole = tile.pixels[i].mean[c];
                lit += whole > 0;
                worst = std::max(worst, std::abs(sum - whole) / std::max(whole, 1e-30));
            }
    EXPECT_LE(worst, 1e-5);
    EXPECT_GT(lit, 100u);
}

/// A room with a lamp, a box, a glass ball and a mirror.
View room() {
    View view;
    addMesh(view.scene, cubeMesh(true), matte({0.7f, 0.6f, 0.5f}));
    addMesh(view.scene, cubeMesh(false), matte({0.2f, 0.5f, 0.7f}), placed({0.5, -0.7, -0.2}, 0.3));
    addMesh(view.scene, sphereMesh(16), smooth(0, 1), placed({-0.4, -0.6, 0.1}, 0.35));
    addMesh(view.scene, sphereMesh(16), smooth(1, 0), placed({0.1, -0.1, -0.6}, 0.3));
    addMesh(view.scene, quadMesh({-0.3f, 0.99f, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}),
            matte(glm::vec3(0), {8, 7, 5}));
    view.camera = cameraAt({-0.1, 0, 0.95}, {0, -0.3, 0}, 1.2);
    return view;
}

/// Every lobe there is, under a sky, a lamp and a sun.
View layers() {
    View view;
    Scene& scene = view.scene;
    Material coated = matte({0.8f, 0.3f, 0.2f});
    coated.ior = 1.5f, coated.roughness = 0.4f, coated.clearcoat = 0.8f, coated.clearcoatRoughness = 0.1f;
    Material cloth = matte({0.3f, 0.2f, 0.6f});
    cloth.sheenColor = {0.6f, 0.7f, 0.8f}, cloth.sheenRoughness = 0.5f;
    Material leaf = matte({0.3f, 0.6f, 0.2f});
    leaf.diffuseTransmission = 0.6f, leaf.diffuseTransmissionColor = {0.7f, 0.9f, 0.2f},
    leaf.doubleSided = true;
    leaf.ior = 1.4f, leaf.roughness = 0.6f;
    Material prism = smooth(0, 1);
    prism.roughness = 0.1f, prism.dispersion = 4, prism.thickness = 1;
    Material rough = smooth(1, 0);
    rough.baseColor = {0.9f, 0.6f, 0.3f}, rough.roughness = 0.5f;
    addMesh(scene, quadMesh({-4, -1, 4}, {8, 0, 0}, {0, 0, -8}), matte({0.5f, 0.5f, 0.5f}));
    const Material* materials[] = {&coated, &cloth, &leaf, &prism, &rough};
    for (int i = 0; i < 5; ++i)
        addMesh(scene, sphereMesh(12), *materials[i], placed({1.1 * (i - 2), -0.4, i % 2 * 0.8}, 0.55));
    scene.environment = uniformEnvironment({0.4f, 0.5f, 0.7f});
    PunctualLight lamp;
    lamp.position = {2, 3, 2};
    lamp.color = glm::vec3(10, 9, 8);
    scene.lights.push_back(lamp);
    PunctualLight sun;
    sun.type = PunctualType::directional, sun.direction = glm::normalize(glm::vec3(-1, -1, -0.5f));
    sun.angularRadius = 0.02f;
    scene.lights.push_back(sun);
    view.camera = cameraAt({0, 0.8, 4}, {0, -0.3, 0}, 0.8);
    return view;
}

TEST_F(ChannelsTest, LightAddsUpToThePictureInARoom) {
    for (const DirectLight direct : {DirectLight::mis, DirectLight::bsdf}) {
        RenderSettings settings = bounces(8);
        settings.directLight = direct;
        expectSums(render(room(), kLight, square(32), settings, 19));
    }
}

TEST_F(ChannelsTest, LightAddsUpToThePictureOfEveryLobe) {
    for (const LightSelection selection : {LightSelection::power, LightSelection::all}) {
        RenderSettings settings = bounces(8);
        settings.lightSelection = selection;
        expectSums(render(layers(), kLight, square(32), settings, 19));
    }
}

TEST_F(ChannelsTest, LightAddsUpWhereSamplesAreDropped) {
    const auto tiles =
        render(room(), kAll, square(48), bounces(3), 64, gpu::bit(gpu::FEATURE_FAULT_INJECTION));
    expectSums(tiles);
    double dropped = 0;
    for (const FilmPixel& pixel : tiles[0].pixels) dropped += pixel.dropped;
    EXPECT_GT(dropped, 0);
}

TEST_F(ChannelsTest, LightAddsUpInFogAndFogsIsOfTheVolume) {
    View view = room();
    view.scene.fog.extinction = {0.4, 0.3, 0.2};
    view.scene.fog.albedo = glm::dvec3(0.9);
    const auto tiles = render(view, kLight, square(32), bounces(6), 19);
    expectSums(tiles);
    double volume = 0;
    for (size_t i = 0; i < tiles[0].pixels.size(); ++i)
        volume += lightOf(tiles[0], i, gpu::LIGHT_PATH_VOLUME);
    EXPECT_GT(volume, 0);
    EXPECT_GT(meanLight(tiles[0], gpu::LIGHT_PATH_VOLUME + 1), 0);
}

// Nothing but a lamp without extent in fog: all light that is seen is scattered in it once or more often.
TEST_F(ChannelsTest, ALampInFogIsSeenByItsVolumeAlone) {
    View view;
    PunctualLight lamp;
    lamp.position = {0, 0.2, 0};
    lamp.color = glm::vec3(1);
    view.scene.lights.push_back(lamp);
    view.scene.fog.extinction = glm::dvec3(0.3);
    view.scene.fog.box = Fog::Box{glm::dvec3(-4), glm::dvec3(4)};
    view.camera = cameraAt({0, 0, 3}, {0, 0, 0}, 1);
    const auto tiles = render(view, kLight, square(16), bounces(3), 64);
    expectSums(tiles);
    expectOnly(tiles[0], {gpu::LIGHT_PATH_VOLUME, gpu::LIGHT_PATH_VOLUME + 1});
}

// ---- What light is called

TEST_F(ChannelsTest, AClosedBoxHasTheSeriesOfItsBounces) {
    View view;
    addMesh(view.scene, cubeMesh(true), matte(glm::vec3(0.5f), glm::vec3(1)));
    view.camera = cameraAt({0, 0, 0.5}, {0, 0, 0}, 1);
    const FilmTile tile = renderTile(view, kLight, bounces(3), 64);
    expectOnly(tile, {gpu::LIGHT_PATH_EMISSION, gpu::LIGHT_PATH_DIFFUSE, gpu::LIGHT_PATH_DIFFUSE + 1});
    EXPECT_NEAR(meanLight(tile, gpu::LIGHT_PATH_EMISSION), 1, 1e-5);
    // Noise: the standard deviation of one direct sample is below 1, and there are 65536.
    EXPECT_NEAR(meanLight(tile, gpu::LIGHT_PATH_DIFFUSE), 0.5, 0.01);
    EXPECT_NEAR(meanLight(tile, gpu::LIGHT_PATH_DIFFUSE + 1), 0.25 + 0.125, 0.01);
}

TEST_F(ChannelsTest, AMirrorShowsTheSkyAsDirectSpecularLight) {
    View view;
    addMesh(view.scene, sphereMesh(32), smooth(1, 0));
    view.scene.environment = uniformEnvironment(glm::vec3(1));
    view.camera = cameraAt({0, 0, 4}, {0, 0, 0}, 0.3);
    const FilmTile tile = renderTile(view, kLight, bounces(4), 16);
    expectOnly(tile, {gpu::LIGHT_PATH_SPECULAR, gpu::LIGHT_PATH_SPECULAR + 1, gpu::LIGHT_PATH_EMISSION});
    EXPECT_NEAR(meanLight(tile, gpu::LIGHT_PATH_SPECULAR), 1, 2e-3);
    EXPECT_EQ(meanLight(tile, gpu::LIGHT_PATH_EMISSION), 0);
}

TEST_F(ChannelsTest, AWindowSplitsLightByItsFresnelReflectance) {
    View view;
    Material pane = smooth(0, 1);
    pane.thickness = 0;
    addMesh(view.scene, quadMesh({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), pane);
    view.scene.environment = uniformEnvironment(glm::vec3(1));
    view.camera = flatCamera();
    const FilmTile tile = renderTile(view, kLight, bounces(4), 256);
    expectOnly(tile, {gpu::LIGHT_PATH_SPECULAR, gpu::LIGHT_PATH_TRANSMISSION});
    // 4 % of 262144 samples: σ = 3.8e-4.
    EXPECT_NEAR(meanLight(tile, gpu::LIGHT_PATH_SPECULAR), 0.04, 1.6e-3);
    EXPECT_NEAR(meanLight(tile, gpu::LIGHT_PATH_TRANSMISSION), 0.96, 1.6e-3);
}

TEST_F(ChannelsTest, ALeafLitFromBehindTransmits) {
    View view;
    Material leaf = matte({0.3f, 0.6f, 0.2f});
    leaf.diffuseTransmission = 0.5f, leaf.diffuseTransmissionColor = glm::vec3(0.8f), leaf.doubleSided = true;
    addMesh(view.scene, quadMesh({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), leaf);
    PunctualLight sun;
    sun.type = PunctualType::directional, sun.direction = {0, 0, 1};
    sun.color = glm::vec3(3.14159265f);
    view.scene.lights.push_back(sun);
    view.camera = flatCamera();
    const FilmTile tile = renderTile(view, kLight, bounces(2), 4);
    expectOnly(tile, {gpu::LIGHT_PATH_TRANSMISSION});
    EXPECT_NEAR(meanLight(tile, gpu::LIGHT_PATH_TRANSMISSION), 0.5 * 0.8, 1e-5);
}

// Black plastic reflects off its interface alone; a white one beside it adds its base to the same reflection.
TEST_F(ChannelsTest, ThePlasticsReflectionIsTheSameOverAnyBase) {
    const auto channels = [&](float base) {
        Material plastic = matte(glm::vec3(base));
        plastic.ior = 1.5f, plastic.roughness = 0.3f;
        View view;
        addMesh(view.scene, quadMesh({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), plastic);
        view.scene.environment = uniformEnvironment(glm::vec3(1));
        view.camera = flatCamera();
        return renderTile(view, kLight, bounces(2), 256);
    };
    const FilmTile black = channels(0), white = channels(1);
    expectOnly(black, {gpu::LIGHT_PATH_SPECULAR});
    expectOnly(white, {gpu::LIGHT_PATH_SPECULAR, gpu::LIGHT_PATH_DIFFUSE});
    const double reflected = meanLight(black, gpu::LIGHT_PATH_SPECULAR);
    EXPECT_NEAR(meanLight(white, gpu::LIGHT_PATH_SPECULAR), reflected, 0.03 * reflected);
    EXPECT_NEAR(meanLight(white, gpu::LIGHT_PATH_SPECULAR) + meanLight(white, gpu::LIGHT_PATH_DIFFUSE), 1,
                5e-3);
}

// ---- Texture coordinates and mattes

TEST_F(ChannelsTest, UvIsThatOfTheFirstSurface) {
    View view;
    Mesh mesh = quadMesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    mesh.uv0 = {{0, 0}, {3, 0}, {3, 1}, {0, 1}};
    addMesh(view.scene, mesh, matte(glm::vec3(0.5f)));
    view.camera = flatCamera();
    RenderSettings settings = bounces(1);
    settings.jitter = false;
    const FilmTile tile = renderTile(view, {.uv = true}, settings, 3, 16);
    for (size_t i = 0; i < tile.pixels.size(); ++i) {
        EXPECT_NEAR(tile.extra[2 * i], 3 * (static_cast<double>(i % 16) + 0.5) / 16, 1e-5);
        EXPECT_NEAR(tile.extra[2 * i + 1], 1 - (static_cast<double>(i / 16) + 0.5) / 16, 1e-5);
    }
}

/// Samples of the pixel that saw the name; of layer 0 objects, 1 materials.
double samplesOf(const FilmTile& tile, size_t pixel, uint32_t layer, const std::string& name) {
    const double id = std::bit_cast<float>(matteId(name));
    const double* pairs =
        &tile.extra[pixel * tile.layout.floats() + tile.layout.means() + layer * 2 * kMatteRanks];
    for (uint32_t i = 0; i < kMatteRanks; ++i)
        if (pairs[2 * i] == id) return pairs[2 * i + 1];
    return 0;
}

void addNamed(Scene& scene, const std::string& node, const std::string& material, const Mesh& mesh,
              const glm::dmat4& toWorld = glm::dmat4(1)) {
    addMesh(scene, mesh, matte(glm::vec3(0.5f)), toWorld);
    scene.instances.back().node = node;
    scene.materials.back().name = material;
}

// A strip that covers 3/8 of the pixels of the middle columns, before a square that covers the left half of
// the picture; nothing elsewhere.
TEST_F(ChannelsTest, MattesCoverWhatTheirSurfacesCover) {
    View view;
    addNamed(view.scene, "Square", "Wood", quadMesh({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}));
    addNamed(view.scene, "Strip", "Iron",
             quadMesh({-0.125f * 3 / 8, -1, 0.1f}, {0.25f * 3 / 8, 0, 0}, {0, 2, 0}));
    view.camera = flatCamera();
    constexpr uint32_t kSamples = 256;
    const FilmTile tile = renderTile(view, kMatte, bounces(1), kSamples, 16);
    double strip = 0;
    for (size_t i = 0; i < tile.pixels.size(); ++i) {
        const size_t x = i % 16;
        const double square = samplesOf(tile, i, 0, "Square"), iron = samplesOf(tile, i, 1, "Iron");
        ASSERT_EQ(samplesOf(tile, i, 1, "Wood"), square);
        ASSERT_EQ(samplesOf(tile, i, 0, "Strip"), iron);
        ASSERT_EQ(square + iron, std::round(tile.pixels[i].alpha * kSamples));
        ASSERT_TRUE(x >= 7 || square == kSamples);
        ASSERT_TRUE(x <= 8 || tile.pixels[i].alpha == 0);
        ASSERT_TRUE(x != 7 || square + iron == kSamples);
        ASSERT_TRUE(x != 8 || square == 0);
        strip += iron;
    }
    // 32 pixels × 256 samples of probability 3/8: σ = 43.8.
    EXPECT_NEAR(strip, 32 * 256 * 0.375, 4 * 43.8);
}

TEST_F(ChannelsTest, NamesOfInstancesShapesAndLightsAreObjects) {
    View view;
    addNamed(view.scene, "Ball", "", sphereMesh(8), placed({-0.5, 0.5, 0}, 0.4));
    view.scene.instances.push_back({0, placed({0.5, 0.5, 0}, 0.4), "Ball"});
    Shape shape;
    shape.name = "Disk", shape.kind = ShapeKind::disk, shape.size = glm::dvec3(0.4);
    shape.toWorld = placed({-0.5, -0.5, 0}, 1);
    view.scene.shapes.push_back(shape);
    AreaLight lamp;
    lamp.shape = AreaShape::sphere, lamp.position = {0.5, -0.5, 0}, lamp.radius = 0.4;
    view.scene.areaLights.push_back(lamp);
    AreaLight panel;
    panel.name = "Panel", panel.u = {0.1, 0, 0}, panel.v = {0, 0.1, 0};
    view.scene.areaLights.push_back(panel);
    view.camera = flatCamera();
    RenderSettings settings = bounces(0);
    settings.jitter = false;
    const FilmTile tile = renderTile(view, kMatte, settings, 2, 64);
    const auto at = [](int x, int y) { return static_cast<size_t>(64 * y + x); };
    for (const size_t pixel : {at(16, 16), at(48, 16)}) {
        EXPECT_EQ(samplesOf(tile, pixel, 0, "Ball"), 2);
        EXPECT_EQ(samplesOf(tile, pixel, 1, "materials/0"), 2);
    }
    EXPECT_EQ(samplesOf(tile, at(16, 48), 0, "Disk"), 2);
    EXPECT_EQ(samplesOf(tile, at(16, 48), 1, "materials/0"), 2);
    EXPECT_EQ(samplesOf(tile, at(48, 48), 0, "light"), 2);
    EXPECT_EQ(samplesOf(tile, at(48, 48), 1, "light"), 2);
    EXPECT_EQ(samplesOf(tile, at(32, 32), 0, "Panel"), 2);
}

TEST_F(ChannelsTest, APixelOfManyObjectsKeepsSixOfThem) {
    View view;
    for (int i = 0; i < 16; ++i)
        addNamed(view.scene, "Strip " + std::to_string(i), "Paint",
                 quadMesh({-1 + 0.125f * static_cast<float>(i), -1, 0}, {0.125f, 0, 0}, {0, 2, 0}));
    view.camera = flatCamera();
    const FilmTile tile = renderTile(view, kMatte, bounces(1), 256, 1);
    double counted = 0;
    int kept = 0;
    for (int i = 0; i < 16; ++i) {
        const double samples = samplesOf(tile, 0, 0, "Strip " + std::to_string(i));
        kept += samples > 0;
        counted += samples;
    }
    EXPECT_EQ(kept, 6);
    // At most what six of 16 strips get; less, as each pass keeps the first six that it meets itself.
    EXPECT_GE(counted, 6);
    EXPECT_LE(counted, 6 + 250 * 0.375 + 4 * 7.7);
    EXPECT_EQ(samplesOf(tile, 0, 1, "Paint"), 256);
}

TEST_F(ChannelsTest, EveryIntegratorSaysWhatItsFirstSurfaceIs) {
    View view;
    addNamed(view.scene, "Square", "Wood", quadMesh({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}));
    view.camera = flatCamera();
    for (const Integrator integrator :
         {Integrator::whitted, Integrator::raster, Integrator::ambientOcclusion, Integrator::albedo}) {
        RenderSettings settings = bounces(1);
        settings.integrator = integrator;
        settings.jitter = false;
        const FilmTile tile = renderTile(view, {.uv = true, .cryptomatte = true}, settings, 2, 8);
        EXPECT_EQ(samplesOf(tile, 3, 0, "Square"), 2);
        EXPECT_EQ(samplesOf(tile, 3, 1, "Wood"), 2);
        EXPECT_NEAR(tile.extra[3 * tile.layout.floats()], 3.5 / 4, 1e-5);
        EXPECT_EQ(samplesOf(tile, 4, 0, "Square"), 0);
    }
}

// ---- Whatever else changes

TEST_F(ChannelsTest, TilesAndFurtherChannelsChangeNoBits) {
    const View view = room();
    const auto large = render(view, kAll, square(40, 128), bounces(4), 7);
    const auto small = render(view, kAll, square(40, 8), bounces(4), 7);
    const auto alone = render(view, {}, square(40, 128), bounces(4), 7);
    const FilmTile& whole = large[0];
    EXPECT_EQ(
        std::memcmp(whole.pixels.data(), alone[0].pixels.data(), whole.pixels.size() * sizeof(FilmPixel)), 0);
    for (const FilmTile& tile : small)
        for (size_t i = 0; i < tile.pixels.size(); ++i) {
            const size_t pixel = (tile.rect.y + i / tile.rect.width) * 40 + tile.rect.x + i % tile.rect.width;
            const uint32_t floats = kAll.floats();
            ASSERT_EQ(
                std::memcmp(&tile.extra[i * floats], &whole.extra[pixel * floats], floats * sizeof(double)),
                0);
        }
}

TEST_F(ChannelsTest, StepsOfAPathStandBehindTheLongerPixels) {
    const View view = room();
    const auto trace = [&](const FilmLayout& layout) {
        Renderer renderer(device, view.scene, view.camera, square(16), bounces(4), layout,
                          gpu::bit(gpu::FEATURE_TRACE));
        return renderer.trace(0, 5, 9, 3);
    };
    const SampleTrace plain = trace({}), with = trace(kAll);
    EXPECT_EQ(with.radiance, plain.radiance);
    ASSERT_EQ(with.steps.size(), plain.steps.size());
    for (size_t i = 0; i < plain.steps.size(); ++i)
        EXPECT_EQ(with.steps[i].position, plain.steps[i].position);
}

}  // namespace
}  // namespace tilefarm
