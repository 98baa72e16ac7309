// A scene that does not call for an effect renders the same bits whether the kernel holds the effect's code
// or not: four effects at a time in the quick form, each by itself in the full one, over scenes that together
// call for many of the others. (All at once would be the strongest test: on lavapipe such a kernel had not
// compiled after 15 minutes and 5 GB, Mesa 25.0.7.)
#include <gtest/gtest.h>

#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "shaders/gpu_types.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/test_scenes.h"
#include "worker/render/features.h"
#include "worker/render/renderer.h"

namespace tilefarm {
namespace {

ImageSpec smallImage() {
    ImageSpec image;
    image.width = image.height = 32;
    return image;
}

glm::dmat4 placed(const glm::dvec3& at, double size) {
    return glm::scale(glm::translate(glm::dmat4(1), at), glm::dvec3(size));
}

struct View {
    Scene scene;
    Camera camera;
};

/// Lambert surfaces lit by a square: calls for nothing but emissive triangles.
View room() {
    View view;
    addMesh(view.scene, cubeMesh(true), matte({0.7f, 0.6f, 0.5f}));
    addMesh(view.scene, cubeMesh(false), matte({0.2f, 0.5f, 0.7f}), placed({0.3, -0.7, -0.2}, 0.3));
    addMesh(view.scene, quadMesh({-0.3f, 0.99f, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}),
            matte(glm::vec3(0), glm::vec3(8)));
    view.camera = cameraAt({-0.5, 0, 0.95}, {0, -0.3, 0}, 1.2);
    return view;
}

Material glossy(float metallic, float roughness) {
    Material m = matte({0.9f, 0.6f, 0.3f});
    m.ior = 1.5f;
    m.metallic = metallic;
    m.roughness = roughness;
    return m;
}

/// Metals, plastic, glass and a textured floor under an environment and a point light.
View studio() {
    View view;
    Scene& scene = view.scene;
    scene.images.push_back(
        {"chequer", 2, 2, {255, 255, 255, 255, 40, 40, 40, 255, 40, 40, 40, 255, 255, 255, 255, 255}, {}});
    Material floor = glossy(0, 0.8f);
    floor.baseColorTexture.image = 0;
    floor.baseColorTexture.srgb = true;
    addMesh(scene, quadMesh({-4, -1, 4}, {8, 0, 0}, {0, 0, -8}), floor);
    addMesh(scene, sphereMesh(16), glossy(1, 0.4f), placed({-1.2, 0, 0}, 0.8));
    addMesh(scene, sphereMesh(16), glossy(0, 0.2f), placed({0, -0.4, 0.8}, 0.6));
    Material glass = glossy(0, 0.1f);
    glass.transmission = 1;
    glass.thickness = 1;
    addMesh(scene, sphereMesh(16), glass, placed({1.2, 0, 0}, 0.8));
    scene.environment = uniformEnvironment({0.4f, 0.5f, 0.7f});
    PunctualLight lamp;
    lamp.position = {2, 3, 2};
    lamp.color = glm::vec3(10);
    scene.lights.push_back(lamp);
    view.camera = cameraAt({0, 0.6, 4}, {0, -0.3, 0}, 0.8);
    return view;
}

/// What a kernel rendered, and the effects it held.
struct Rendered {
    std::vector<PassPixel> pixels;
    uint64_t features = 0;
};

std::string namesOf(uint64_t features) {
    std::string names;
    for (uint32_t bit = 0; bit < gpu::FEATURE_COUNT; ++bit)
        if ((features >> bit & 1u) != 0) names += (names.empty() ? "" : ", ") + std::string(featureName(bit));
    return names;
}

class FeatureBitsTest : public DeviceTest, public testing::WithParamInterface<uint32_t> {
protected:
    Rendered render(const View& view, uint64_t forcedFeatures) {
        RenderSettings settings;
        settings.maxBounces = 5;
        settings.culling = Culling::none;
        Renderer renderer(device, view.scene, view.camera, smallImage(), settings, {}, forcedFeatures);
        return {renderer.render(0, std::vector<uint32_t>{0}, {0, 4}).front().pixels, renderer.featureBits()};
    }

    /// Renders with those of the features that the scene does not call for; the others are returned.
    uint64_t compare(const View& view, const std::string& name, uint64_t features) {
        const Rendered plain = render(view, 0);
        const uint64_t more = features & ~plain.features;
        if (more == 0) return features;
        const Rendered with = render(view, more);
        EXPECT_NE(with.features, plain.features);
        size_t other = 0;
        for (size_t i = 0; i < plain.pixels.size(); ++i)
            other += std::memcmp(&plain.pixels[i], &with.pixels[i], sizeof(PassPixel)) != 0;
        EXPECT_EQ(other, 0u) << "pixels of the " << name << " that changed with " << namesOf(more);
        return features & ~more;
    }
};

constexpr uint32_t kTogether = 4;

TEST_P(FeatureBitsTest, ScenesThatDoNotCallForThemKeepTheirBits) {
    uint64_t features = 0;
    for (uint32_t bit = GetParam(); bit < std::min(GetParam() + kTogether, gpu::FEATURE_COUNT); ++bit)
        features |= gpu::bit(bit);
    const uint64_t left =
        compare(room(), "room", features);  // its kernels compile in a third of the studio's time
    EXPECT_TRUE(left == 0 || compare(studio(), "studio", left) == 0) << "both call for " << namesOf(left);
}

INSTANTIATE_TEST_SUITE_P(From, FeatureBitsTest, testing::Range(0u, gpu::FEATURE_COUNT + 0u, kTogether));

class FeatureBitTest : public FeatureBitsTest {};

TEST_P(FeatureBitTest, FullScenesThatDoNotCallForItKeepTheirBits) {
    const uint64_t feature = gpu::bit(GetParam());
    const uint64_t left = compare(studio(), "studio", feature) & compare(room(), "room", feature);
    EXPECT_EQ(left, 0u) << "both call for " << namesOf(left);
}

std::string wordOf(const testing::TestParamInfo<uint32_t>& info) {
    std::string word;
    for (const char c : featureName(info.param))
        if (std::isalnum(static_cast<unsigned char>(c)) != 0) word += c;
    return word;
}

INSTANTIATE_TEST_SUITE_P(Every, FeatureBitTest, testing::Range(0u, gpu::FEATURE_COUNT + 0u), wordOf);

}  // namespace
}  // namespace tilefarm
