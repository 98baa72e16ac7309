// Layers and diffuse bases in whole pictures whose value is known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "shaders/gpu_types.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/test_scenes.h"
#include "worker/render/albedo_table.h"
#include "worker/render/renderer.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

struct Mean {
    glm::dvec3 value{0};
    double sigma = 0;  // of red
};

class LayersRenderTest : public DeviceTest {
protected:
    /// A 16 × 16 picture.
    std::vector<PassPixel> pixels(const Scene& scene, const Camera& camera, uint32_t samples,
                                  uint32_t bounces, uint64_t forcedFeatures = 0) {
        ImageSpec image;
        image.width = image.height = 16;
        image.tileSize = 16;
        RenderSettings settings;
        settings.maxBounces = bounces;
        settings.rouletteStart = bounces;
        settings.culling = Culling::none;
        Renderer renderer(device, scene, camera, image, settings, {}, forcedFeatures);
        return renderer.render(0, std::vector<uint32_t>{0}, {0, samples}).front().pixels;
    }

    /// Its mean radiance.
    Mean render(const Scene& scene, const Camera& camera, uint32_t samples, uint32_t bounces) {
        Mean mean;
        double variance = 0;
        const std::vector<PassPixel> picture = pixels(scene, camera, samples, bounces);
        for (const PassPixel& p : picture) {
            mean.value += glm::dvec3(p.mean[0], p.mean[1], p.mean[2]);
            variance += double{p.m2[0]} / (double(samples) * (samples - 1));
        }
        const auto n = static_cast<double>(picture.size());
        mean.value /= n;
        mean.sigma = std::sqrt(variance) / n;
        return mean;
    }
};

/// Straight at the origin's plane z = 0 from +z, over a small part of it.
Camera headOn() {
    return cameraAt({0, 0, 4}, {0, 0, 0}, 0.02);
}

Mesh wall() {
    return quadMesh({-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
}

TEST_F(LayersRenderTest, CoatDimsEmissionByItsAlbedo) {
    // A glowing, coated panel above a matte floor, found by light sampling and by BSDF sampling alike.
    Material panel = matte(glm::vec3(0), glm::vec3(3));
    panel.clearcoat = 1;
    panel.clearcoatRoughness = 0.5f;
    Scene scene;
    addMesh(scene, wall(), matte(glm::vec3(0.5f)));
    addMesh(scene, quadMesh({-1, 1, 1}, {2, 0, 0}, {0, -2, 0}), panel);
    const Mean lit = render(scene, cameraAt({1.6, 0, 0.9}, {0.3, 0, 0}, 0.02), 512, 1);
    double expected = 0;
    constexpr int n = 100;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double x = -1 + 2 * (i + 0.5) / n - 0.3, y = -1 + 2 * (j + 0.5) / n;
            const double squared = x * x + y * y + 1, cosine = 1 / std::sqrt(squared);
            expected += (1 - reflectionAlbedo(cosine, 0.25, 1.5)) * cosine * cosine / squared;
        }
    expected *= 3 * 0.5 / pi * 4 / (n * n);
    EXPECT_NEAR(lit.value.r, expected, 4 * lit.sigma + 1e-3 * expected);

    Scene alone;
    addMesh(alone, wall(), panel);
    const Mean seen = render(alone, headOn(), 4, 0);
    EXPECT_NEAR(seen.value.r, 3 * (1 - reflectionAlbedo(1, 0.25, 1.5)), 5e-3);
}

TEST_F(LayersRenderTest, CoatedWhiteIsInvisibleInAWhiteWorldButForItsEdges) {
    Material lacquer = matte(glm::vec3(1));
    lacquer.clearcoat = 1;
    lacquer.clearcoatRoughness = 0.3f;
    Scene scene;
    addMesh(scene, wall(), lacquer);
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Mean mean = render(scene, headOn(), 64, 2);
    EXPECT_NEAR(mean.value.r, 1, 4 * mean.sigma + 3e-3);
}

TEST_F(LayersRenderTest, CoatIgnoresTheBumpsOfItsBase) {
    // The base's normal map leans 45° to the right; a mirror coat without one shows what is straight ahead.
    Scene scene;
    scene.images.push_back({"leaning", 1, 1, {218, 128, 218, 255}, {}});
    Material m = matte(glm::vec3(0));
    m.normalTexture.image = 0;
    m.clearcoat = 1;
    Mesh plane = wall();
    plane.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    plane.normals.assign(plane.positions.size(), {0, 0, 1});
    plane.tangents.assign(plane.positions.size(), {1, 0, 0, 1});
    addMesh(scene, plane, m);
    addMesh(scene, quadMesh({-1, -1, 8}, {0, 2, 0}, {2, 0, 0}), matte(glm::vec3(0), glm::vec3(1)));
    EXPECT_NEAR(render(scene, headOn(), 64, 1).value.r, 0.04, 1e-3);
    // With the same map of its own it looks to the right, past the light.
    scene.materials.front().clearcoatNormalTexture.image = 0;
    EXPECT_EQ(render(scene, headOn(), 16, 1).value.r, 0);
}

TEST_F(LayersRenderTest, LightBehindAThinSheetShinesThrough) {
    Material paper = matte({0.7f, 0.7f, 0.7f});
    paper.diffuseTransmission = 0.4f;
    paper.diffuseTransmissionColor = {0.9f, 0.5f, 0.1f};
    Scene scene;
    addMesh(scene, wall(), paper);
    PunctualLight lamp;
    lamp.position = {0, 0, -2};
    lamp.color = glm::vec3(10);
    scene.lights.push_back(lamp);
    const Mean mean = render(scene, headOn(), 4, 1);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean.value[c], 0.4 * paper.diffuseTransmissionColor[c] / pi * 10 / 4, 1e-3) << c;
}

TEST_F(LayersRenderTest, LightThroughASolidFadesByBeerLambert) {
    // A thin, wide slab whose faces let all light through diffusely: a ray enters at an angle θ and leaves
    // after 1/cosθ. Seen from the front under a white sky, of light that crosses once: 2 ∫ e^(−σ/μ) μ dμ.
    Material slab = matte(glm::vec3(0));
    slab.diffuseTransmission = 1;
    slab.thickness = 1;
    slab.attenuationColor = glm::vec3(std::exp(-1.f));
    slab.attenuationDistance = 1;
    Scene scene;
    addMesh(scene, cubeMesh(false), slab, glm::scale(glm::dmat4(1), glm::dvec3(500, 500, 0.5)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Mean mean = render(scene, headOn(), 256, 4);
    double expected = 0;
    constexpr int n = 10000;
    for (int i = 0; i < n; ++i) {
        const double mu = (i + 0.5) / n;
        expected += 2 * mu * std::exp(-1 / mu) / n;
    }
    EXPECT_NEAR(mean.value.r, expected, 4 * mean.sigma + 1e-3);
}

TEST_F(LayersRenderTest, LampInsideASolidFadesByBeerLambert) {
    Material slab = matte(glm::vec3(0));
    slab.diffuseTransmission = 1;
    slab.thickness = 1;
    slab.attenuationColor = {0.5f, 0.25f, 1};
    slab.attenuationDistance = 0.5f;
    Scene scene;
    addMesh(scene, cubeMesh(false), slab, glm::scale(glm::dmat4(1), glm::dvec3(50, 50, 0.5)));
    PunctualLight lamp;
    lamp.color = glm::vec3(10);
    scene.lights.push_back(lamp);
    const Mean mean = render(scene, headOn(), 4, 1);
    // The picture's corners see it off the axis: half a percent in mean.
    for (int c = 0; c < 3; ++c) {
        const double expected = slab.attenuationColor[c] * 10 / (0.5 * 0.5) / pi;
        EXPECT_NEAR(mean.value[c], expected, 0.01 * expected) << c;
    }
}

TEST_F(LayersRenderTest, UnlitShowsItsColourWhateverItsLayers) {
    Material m = matte({0.2f, 0.4f, 0.6f});
    m.unlit = true;
    m.clearcoat = 1;
    m.sheenColor = glm::vec3(1);
    m.diffuseTransmission = 1;
    Scene scene;
    addMesh(scene, wall(), m);
    scene.environment = uniformEnvironment(glm::vec3(5));
    const Mean mean = render(scene, headOn(), 4, 4);
    EXPECT_NEAR(mean.value.r, 0.2, 1e-6);
    EXPECT_NEAR(mean.value.b, 0.6, 1e-6);
}

// The code of one lobe compiled in beside another that is used: no bit of the picture may change.
TEST_F(LayersRenderTest, FullLobesKeepTheirBitsBesideTheCodeOfOthers) {
    using gpu::bit;
    const auto scene = [](const Material& left, const Material& right) {
        Scene result;
        addMesh(result, sphereMesh(12), left, glm::translate(glm::dmat4(1), glm::dvec3(-1, 0, 0)));
        addMesh(result, sphereMesh(12), right, glm::translate(glm::dmat4(1), glm::dvec3(1, 0, 0)));
        result.environment = uniformEnvironment({0.4f, 0.6f, 0.9f});
        return result;
    };
    Material coated = matte({0.6f, 0.2f, 0.1f}), cloth = coated, leaf = coated, clay = coated;
    coated.clearcoat = 0.7f;
    coated.clearcoatRoughness = 0.3f;
    cloth.sheenColor = {0.9f, 0.8f, 1};
    cloth.sheenRoughness = 0.4f;
    leaf.diffuseTransmission = 0.5f;
    leaf.disneySheen = 1;
    clay.orenNayarSigma = 0.6f;
    const Camera camera = cameraAt({0, 0, 6}, {0, 0, 0}, 0.7);
    const auto expectSameBits = [&](const Scene& s, uint64_t others) {
        const auto plain = pixels(s, camera, 4, 3), with = pixels(s, camera, 4, 3, others);
        EXPECT_EQ(std::memcmp(plain.data(), with.data(), plain.size() * sizeof(PassPixel)), 0);
    };
    expectSameBits(scene(coated, cloth), bit(gpu::FEATURE_DIFFUSE_TRANSMISSION) |
                                             bit(gpu::FEATURE_OREN_NAYAR) | bit(gpu::FEATURE_DISNEY_DIFFUSE) |
                                             bit(gpu::FEATURE_DISNEY_SHEEN) | bit(gpu::FEATURE_GTR1) |
                                             bit(gpu::FEATURE_SPECULAR));
    expectSameBits(scene(leaf, clay), bit(gpu::FEATURE_CLEARCOAT) | bit(gpu::FEATURE_SHEEN) |
                                          bit(gpu::FEATURE_DISNEY_DIFFUSE) | bit(gpu::FEATURE_TRANSMISSION) |
                                          bit(gpu::FEATURE_SPECULAR) | bit(gpu::FEATURE_MIRROR));
}

TEST_F(LayersRenderTest, TexturesScaleLayersByTheirChannels) {
    // One texel: r 0.4 weighs the coat; g roughness; a sheen roughness, diffuse transmission; rgb through
    // sRGB.
    Scene scene;
    scene.images.push_back({"one", 1, 1, {102, 0, 255, 51}, {}});
    TextureRef texture;
    texture.image = 0;
    Material m = matte(glm::vec3(0), glm::vec3(1));
    m.clearcoat = 1;
    m.clearcoatTexture = m.clearcoatRoughnessTexture = texture;
    m.clearcoatRoughness = 1;
    Mesh plane = wall();
    plane.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    addMesh(scene, plane, m);
    EXPECT_NEAR(render(scene, headOn(), 4, 0).value.r, 1 - 0.4 * 0.04, 1e-5);

    m = matte(glm::vec3(0));
    m.diffuseTransmission = 1;
    m.diffuseTransmissionTexture = m.diffuseTransmissionColorTexture = texture;
    m.diffuseTransmissionColorTexture.srgb = true;
    scene.materials.front() = m;
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Mean mean = render(scene, headOn(), 256, 1);
    EXPECT_NEAR(mean.value.r, 0.2 * std::pow((0.4 + 0.055) / 1.055, 2.4), 4 * mean.sigma + 1e-4);
    EXPECT_EQ(mean.value.g, 0);
}

}  // namespace
}  // namespace tilefarm
