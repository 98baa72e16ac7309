// Cases 32 and 33: environments that are all black but for a texel, huge, or broken, and the ways to sample
// them.
#include <cmath>
#include <limits>
#include <numbers>

#include "shared/image/exr.h"
#include "tests/numerics/picture.h"
#include "tests/numerics/probe_runner.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/triangle_scenes.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class HardEnvironment : public DeviceTest {};

using Radiance = float (*)(uint32_t x, uint32_t y);

Environment mapOf(uint32_t width, uint32_t height, Radiance radiance) {
    Environment map = uniformEnvironment(glm::vec3(0), width, height);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            for (size_t c = 0; c < 3; ++c)
                map.image.rgbaFloat[4 * (size_t{y} * width + x) + c] = radiance(x, y);
    return map;
}

/// ∫ L cosθ dω over the upper hemisphere of the bilinear map, in double: n² points per texel.
double irradianceOf(const Image& map, int n) {
    const auto texel = [&](int x, int y) {
        const int w = static_cast<int>(map.width), h = static_cast<int>(map.height);
        x = (x % w + w) % w;
        y = std::clamp(y, 0, h - 1);
        return double{map.rgbaFloat[4 * static_cast<size_t>(y * w + x)]};
    };
    double sum = 0;
    const double dx = 1.0 / n;
    for (int j = 0; j < n * static_cast<int>(map.height) / 2; ++j)
        for (int i = 0; i < n * static_cast<int>(map.width); ++i) {
            const double u = (i + 0.5) * dx - 0.5, v = (j + 0.5) * dx - 0.5;
            const int x = static_cast<int>(std::floor(u)), y = static_cast<int>(std::floor(v));
            const double s = u - x, t = v - y, theta = pi * (v + 0.5) / map.height;
            const double value = (1 - t) * ((1 - s) * texel(x, y) + s * texel(x + 1, y)) +
                                 t * ((1 - s) * texel(x, y + 1) + s * texel(x + 1, y + 1));
            sum += value * std::cos(theta) * std::sin(theta);
        }
    return sum * dx * dx * (2 * pi / map.width) * (pi / map.height);
}

Scene floorUnder(const Environment& map) {
    Scene scene;
    addMesh(scene, quadMesh({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}), matte(glm::vec3(0.5f)));
    scene.environment = map;
    return scene;
}

Camera downwards() {
    return cameraAt({1, 1, 0}, {1, 0, 0}, 1e-3);
}

float oneTexel(uint32_t x, uint32_t y) {
    return x == 20 && y == 4 ? 100.0f : 0.0f;
}
float everyThirdRow(uint32_t, uint32_t y) {
    return y % 3 == 1 ? 2.0f : 0.0f;
}
float polesAlone(uint32_t, uint32_t y) {
    return y == 0 || y == 15 ? 30.0f : 0.0f;
}
float wild(uint32_t x, uint32_t y) {
    return 0.01f + std::exp2(static_cast<float>((x * 2654435761u + y * 40503u) >> 7 & 15u)) / 256;
}

TEST_F(HardEnvironment, HardCase32_Environments) {
    Scene black = floorUnder(uniformEnvironment(glm::vec3(0)));
    const Picture dark = render(device, black, downwards(), {.size = 8, .samples = 4});
    EXPECT_EQ(blackPixels(dark), dark.pixels.size());
    EXPECT_TRUE(allFinite(dark));
    EXPECT_EQ(dark.stats.droppedSamples, 0u);

    for (const auto& [radiance, what] : {std::pair(&oneTexel, "one texel"),
                                         {&everyThirdRow, "black rows"},
                                         {&polesAlone, "poles alone"},
                                         {&wild, "all over"}}) {
        SCOPED_TRACE(what);
        const Environment map = mapOf(32, 16, radiance);
        const Picture picture =
            render(device, floorUnder(map), downwards(), {.size = 16, .samples = 64, .maxBounces = 1});
        // The oracle's midpoints are off by 1e-5 of what they sum.
        expectMean(meanOf(picture), 0.5 / pi * irradianceOf(map.image, 40), 1e-4);
        EXPECT_EQ(picture.stats.droppedSamples, 0u);
    }
}

TEST_F(HardEnvironment, HardCase32_WeightsOfOneTexel) {
    // Chosen in proportion to bilinear (L sin θ of the row), while radiance is bilinear L: the weights of the
    // samples of one texel differ by the sine within the two rows around it, 5 % at 45° in 128 rows.
    Scene scene;
    scene.environment =
        mapOf(256, 128, [](uint32_t x, uint32_t y) { return x == 7 && y == 32 ? 1.0f : 0.0f; });
    const uint32_t count = 20'000;
    const auto samples = Probe(device, scene).run(PROBE_ENVIRONMENT, count, {}, 2).values;
    float least = std::numeric_limits<float>::infinity(), most = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const float pdf = samples[2 * i].w, found = samples[2 * i + 1].w, radiance = samples[2 * i + 1].x;
        if (!(radiance > 1e-3f)) continue;  // out at the foot of the tent fp32 has few digits of the offset
        least = std::min(least, radiance / pdf);
        most = std::max(most, radiance / pdf);
        // What multiple importance sampling weighs with: the pdf that the direction alone gives. The
        // direction has 24 bits, one texel of 256 is 8 of them.
        ASSERT_NEAR(found, pdf, 2e-3f * pdf + 2e-3f * samples[0].w) << i;
    }
    EXPECT_LE(most / least, 1.12f);
    EXPECT_GE(least, 0);
}

/// Share of the samples that land on each texel: a tent of a texel's pick leaves 1/8 of it on either
/// neighbour.
std::vector<double> landingShares(const PackedEnvironment& packed) {
    const int w = static_cast<int>(packed.width), h = static_cast<int>(packed.height);
    std::vector<double> shares(packed.texels.size());
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const int from = std::clamp(y + dy, 0, h - 1) * w + (x + dx + w) % w;
                    shares[static_cast<size_t>(y * w + x)] +=
                        (dx ? 0.125 : 0.75) * (dy ? 0.125 : 0.75) *
                        double{packed.texels[static_cast<size_t>(from)].a} / packed.weightSum;
                }
    return shares;
}

void expectPicksInProportion(const gpu::Device& device, uint32_t width, uint32_t height, uint32_t samples) {
    Scene scene;
    scene.environment = mapOf(width, height, wild);
    const PackedEnvironment packed = packEnvironment(scene.environment);
    double sum = 0;
    for (const gpu::AliasRecord& entry : packed.alias) sum += double{entry.pmf};
    EXPECT_NEAR(sum, 1, 1e-6);

    const auto drawn = Probe(device, scene).run(PROBE_ENVIRONMENT, samples, {}, 2).values;
    const std::vector<double> shares = landingShares(packed);
    // In blocks of texels, so that each expects enough.
    const uint32_t columns = std::min(width, 64u), rows = std::min(height, 32u);
    std::vector<double> expected(columns * rows), observed(columns * rows);
    for (size_t i = 0; i < shares.size(); ++i)
        expected[i / width * rows / height * columns + i % width * columns / width] += shares[i] * samples;
    for (uint32_t i = 0; i < samples; ++i) {
        const glm::dvec3 d(drawn[2 * i]);
        const double u = 0.5 + std::atan2(d.z, d.x) / (2 * pi),
                     v = std::acos(std::clamp(d.y, -1.0, 1.0)) / pi;
        const auto column = std::min(static_cast<uint32_t>(u * columns), columns - 1),
                   row = std::min(static_cast<uint32_t>(v * rows), rows - 1);
        ++observed[row * columns + column];
    }
    expectChiSquare(observed, expected);
}

TEST_F(HardEnvironment, HardCase32_TexelPicks) {
    expectPicksInProportion(device, 512, 256, 200'000);
}
TEST_F(HardEnvironment, FullHardCase32_TexelPicks) {
    expectPicksInProportion(device, 8192, 4096, 4'000'000);
}

TEST_F(HardEnvironment, FullHardCase32_LargeMapIsUnbiased) {
    const Environment map = mapOf(8192, 4096, wild);
    const Picture picture =
        render(device, floorUnder(map), downwards(), {.size = 32, .samples = 1024, .maxBounces = 1});
    expectMean(meanOf(picture), 0.5 / pi * irradianceOf(map.image, 1), 1e-4);
    EXPECT_EQ(picture.stats.droppedSamples, 0u);
}

TEST_F(HardEnvironment, HardCase33_EstimatorsAgree) {
    // The sun is a texel of a coarse map, so that the BSDF finds it often enough to have an error that says
    // something.
    for (const auto& [map, samples] :
         {std::pair(uniformEnvironment(glm::vec3(1)), 16u), {mapOf(32, 16, oneTexel), 512u}}) {
        std::vector<Mean> means;
        for (const DirectLight mode : {DirectLight::mis, DirectLight::lights, DirectLight::bsdf}) {
            const Shot shot{.size = 16,
                            .samples = mode == DirectLight::bsdf ? samples : 64,
                            .maxBounces = 1,
                            .seed = static_cast<uint32_t>(mode) + 1,
                            .directLight = mode};
            means.push_back(meanOf(render(device, floorUnder(map), downwards(), shot)));
            EXPECT_LT(means.back().sigma, 0.05 * means.back().value);
        }
        expectSameMean(means[0], means[1]);
        expectSameMean(means[0], means[2]);
        expectSameMean(means[1], means[2]);
    }
}

TEST_F(HardEnvironment, HardCase32_TexelsThatAreNoRadiance) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                    inf = std::numeric_limits<float>::infinity();
    TemporaryFolder folder;
    FloatImage file{32, 16, {"R", "G", "B"}, {}};
    file.planes.assign(3, std::vector<float>(32 * 16, 0.5f));
    for (size_t i = 0; i < 5; ++i) file.planes[i % 3][40 + 3 * i] = std::array{nan, inf, -inf, -1.0f, nan}[i];
    writeExr(folder / "sky.exr", file);
    Scene scene = floorUnder({});
    loadEnvironment(scene, folder / "sky.exr");
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].instead.find("5 texels"), std::string::npos) << scene.warnings[0].instead;
    const Picture picture = render(device, scene, downwards(), {.size = 16, .samples = 32, .maxBounces = 1});
    expectMean(meanOf(picture), 0.5 / pi * irradianceOf(scene.environment.image, 40), 1e-4);
    EXPECT_EQ(picture.stats.droppedSamples, 0u);
}

}  // namespace
}  // namespace tilefarm
