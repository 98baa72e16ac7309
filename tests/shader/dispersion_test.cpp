// Dispersion: one channel per path must give on average what three renders with an index each give.
#include <numeric>

#include "tests/shader/device_fixture.h"
#include "tests/support/test_scenes.h"
#include "worker/render/renderer.h"

namespace tilefarm {
namespace {

struct Estimate {
    glm::dvec3 mean{0}, variance{0};
};

class DispersionTest : public DeviceTest {
protected:
    Scene glassBall(float ior, float dispersion) {
        Material glass = matte(glm::vec3(1));
        glass.ior = ior;
        glass.roughness = 0.3f;
        glass.transmission = 1;
        glass.thickness = 1;
        glass.dispersion = dispersion;
        Scene scene;
        addMesh(scene, sphereMesh(24), glass);
        // Bright above, dark below: what refraction brings depends on the index.
        Environment sky = uniformEnvironment(glm::vec3(1));
        sky.image.width = 4;
        sky.image.height = 4;
        sky.image.rgbaFloat.assign(4 * 4 * 4, 0.05f);
        for (size_t x = 0; x < 4; ++x)
            for (size_t c = 0; c < 4; ++c) sky.image.rgbaFloat[(4 + x) * 4 + c] = 4;
        scene.environment = sky;
        return scene;
    }

    Estimate render(const Scene& scene) {
        ImageSpec image;
        image.width = image.height = 32;
        RenderSettings settings;
        settings.maxBounces = 6;
        settings.culling = Culling::none;
        Renderer renderer(device, scene, cameraAt({0, 0, 4}, {0, 0.3, 0}, 0.25), image, settings);
        const auto film = renderer.render(0, std::vector<uint32_t>{0}, {0, 64});
        Estimate e;
        for (const PassPixel& pixel : film.front().pixels)
            for (int c = 0; c < 3; ++c) {
                e.mean[c] += pixel.mean[static_cast<size_t>(c)] / 1024;
                e.variance[c] += pixel.m2[static_cast<size_t>(c)] / (63.0 * 64) / (1024.0 * 1024);
            }
        return e;
    }
};

TEST_F(DispersionTest, ChannelsAverageToRendersWithTheirOwnIndex) {
    const float dispersion = 8;
    const Estimate dispersed = render(glassBall(1.5f, dispersion));
    for (int c = 0; c < 3; ++c) {
        const float ior = 1.5f + float(c - 1) * 0.5f * 0.025f * dispersion;
        const Estimate alone = render(glassBall(ior, 0));
        EXPECT_NEAR(dispersed.mean[c], alone.mean[c],
                    4 * std::sqrt(dispersed.variance[c] + alone.variance[c]) + 2e-3)
            << "channel " << c;
    }
    EXPECT_GT(std::abs(dispersed.mean.r - dispersed.mean.b),
              4 * std::sqrt(dispersed.variance.r + dispersed.variance.b));
}

}  // namespace
}  // namespace tilefarm
