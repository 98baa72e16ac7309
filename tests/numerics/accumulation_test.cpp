// Cases 41, 42, 45, 49, 52: numbers, frames, and sums.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include "shaders/gpu_types.h"
#include "shared/error/error.h"
#include "shared/image/exr.h"
#include "tests/numerics/picture.h"
#include "tests/numerics/probe_runner.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/triangle_scenes.h"

namespace tilefarm {
namespace {

class HardSums : public DeviceTest {};

TEST_F(HardSums, HardCase41_RandomNumbersStayBelowOne) {
    const auto counters = Probe(device).run(PROBE_UNIT_FLOATS, 1u << 24, {}, 0).counters;
    EXPECT_EQ(counters[0], 0u) << "of all 2^24 mantissas";
    EXPECT_EQ(std::bit_cast<float>(counters[1]), 1 - 0x1p-24f);
}

/// 2^log2 samples of 0.1 with 1e4 spikes of 1e4 among them, as passes of 256 in the kernel's film, merged in
/// double.
void expectExactSum(const gpu::Device& device, uint32_t log2) {
    const uint64_t samples = uint64_t{1} << log2, every = samples / 10'000 + 1;
    const uint64_t spikes = (samples - 1) / every + 1;
    const auto passes = static_cast<uint32_t>(samples / PROBE_PASS_SAMPLES);
    const auto films = Probe(device).run(PROBE_PASS_FILMS, passes, {glm::vec4(float(every))}, 2).values;
    FilmPixel pixel;
    for (uint32_t i = 0; i < passes; ++i) {
        PassPixel pass;
        std::memcpy(static_cast<void*>(&pass), &films[2 * i], sizeof(glm::vec4) * 2);
        pixel.merge(pass, PROBE_PASS_SAMPLES);
    }
    const double tenth = double{0.1f}, n = static_cast<double>(samples), k = static_cast<double>(spikes);
    const double mean = ((n - k) * tenth + k * PROBE_SPIKE) / n;
    EXPECT_EQ(pixel.count, n);
    recordWorst("relative", std::abs(pixel.mean[0] - mean) / mean);
    EXPECT_NEAR(pixel.mean[0], mean, 1e-6 * mean);
    const double m2 =
        k * (PROBE_SPIKE - mean) * (PROBE_SPIKE - mean) + (n - k) * (tenth - mean) * (tenth - mean);
    EXPECT_NEAR(pixel.m2[0], m2, 1e-5 * m2);

    float plain = 0;
    for (uint64_t i = 0; i < samples; ++i) plain += i % every == 0 ? float(PROBE_SPIKE) : 0.1f;
    EXPECT_GT(std::abs(double{plain} / n - mean), 1e-3 * mean) << "a plain sum in fp32 should fail here";
}

TEST_F(HardSums, HardCase42_ManySamplesWithSpikes) {
    expectExactSum(device, 22);
}
TEST_F(HardSums, FullHardCase42_ManySamplesWithSpikes) {
    for (const uint32_t log2 : {24u, 26u, 28u}) expectExactSum(device, log2);
}

// ---- 43

/// shaders/rng.glsl's pcg4d, to know which samples the kernel makes NaN.
glm::uvec4 pcg4d(glm::uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w, v.y += v.z * v.x, v.z += v.x * v.y, v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w, v.y += v.z * v.x, v.z += v.x * v.y, v.w += v.y * v.z;
    return v;
}

bool isInjected(uint32_t seed, uint32_t x, uint32_t y, uint32_t sample) {
    const uint32_t stream = pcg4d({seed, 0, 0x7469u, 0x6c65u}).x, dimension = 7;
    return pcg4d({x | y << 16, sample, dimension, stream}).x < gpu::INJECTION_THRESHOLD;
}

TEST_F(HardSums, HardCase43_InjectedNaN) {
    // A wall whose samples differ, in one bounce: 2^20 of them, of which about ten are NaN.
    Scene scene;
    addMesh(scene, quadMesh({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}), matte(glm::vec3(0.5f)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Camera camera = cameraAt({0, 0, 3}, {0, 0, 0}, 1);
    const Shot shot{.size = 128, .samples = 64, .maxBounces = 1};
    Shot injected = shot;
    injected.forcedFeatures = gpu::bit(gpu::FEATURE_FAULT_INJECTION);
    const Picture clean = render(device, scene, camera, shot),
                  picture = render(device, scene, camera, injected);
    EXPECT_TRUE(allFinite(picture));

    std::vector<DroppedSample> expected;
    for (uint32_t y = 0; y < shot.size; ++y)
        for (uint32_t x = 0; x < shot.size; ++x) {
            uint32_t here = 0;
            for (uint32_t k = 0; k < shot.samples; ++k)
                if (isInjected(shot.seed, x, y, k)) expected.push_back({x, y, k}), ++here;
            const FilmPixel& pixel = picture.pixels[y * shot.size + x];
            ASSERT_EQ(pixel.dropped, here);
            ASSERT_EQ(pixel.count, shot.samples - here);
            if (here == 0) {
                ASSERT_EQ(pixel.mean, clean.pixels[y * shot.size + x].mean) << x << ", " << y;
            }
        }
    ASSERT_GT(expected.size(), 3u);
    EXPECT_EQ(picture.stats.droppedSamples, expected.size()) << "the counter is exact";
    // Those named are among them; single samples show what the kept ones were.
    EXPECT_EQ(picture.stats.faults.dropped.size(), std::min(expected.size(), kMostDropped));
    for (const DroppedSample& s : picture.stats.faults.dropped)
        EXPECT_NE(std::find(expected.begin(), expected.end(), s), expected.end());
    ImageSpec image = imageOf(shot);
    image.tileSize = 8;
    Renderer single(device, scene, camera, image, settingsOf(shot));
    for (size_t i = 0; i < 3; ++i) {
        const auto& [x, y, sample] = expected[i];
        const std::vector<uint32_t> tile{y / 8 * TileGrid(image).columns + x / 8};
        double kept = 0;
        int n = 0;
        for (uint32_t k = 0; k < shot.samples; ++k) {
            if (isInjected(shot.seed, x, y, k)) continue;
            kept += double{single.render(0, tile, {k, 1})[0].pixels[y % 8 * 8 + x % 8].mean[0]};
            ++n;
        }
        EXPECT_NEAR(picture.pixels[y * shot.size + x].mean[0], kept / n, 1e-6 * kept / n);
    }
}

TEST_F(HardSums, HardCase43_ADroppedSampleCanBeRenderedAlone) {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte(glm::vec3(0.5f), glm::vec3(0.5f)));
    const Camera camera = cameraAt({0, 0, 0}, {0.3, 0.2, -1}, 1.2);
    const Shot shot{.size = 16, .maxBounces = 5};
    Renderer traced(device, scene, camera, imageOf(shot), settingsOf(shot), {}, gpu::bit(gpu::FEATURE_TRACE));
    Renderer plain(device, scene, camera, imageOf(shot), settingsOf(shot));
    const auto film = plain.render(0, std::vector<uint32_t>{0}, {7, 1});
    const SampleTrace trace = traced.trace(0, 11, 6, 7);
    const PassPixel& pixel = film[0].pixels[6 * 16 + 11];
    EXPECT_EQ(trace.radiance, glm::vec3(pixel.mean[0], pixel.mean[1], pixel.mean[2]));
    ASSERT_GE(trace.steps.size(), 4u) << "roulette starts at bounce 4";
    EXPECT_EQ(trace.steps[0].t, pixel.depth);
    EXPECT_EQ(trace.steps[0].throughput, glm::vec3(1));
    // A wall reflects half, whatever the direction.
    EXPECT_NEAR(trace.steps[1].throughput.x, 0.5f, 1e-6f);
    EXPECT_NEAR(trace.steps[3].throughput.x, 0.125f, 1e-6f);
    EXPECT_GT(film[0].faults.truncatedPaths, 0u) << "five bounces end paths that carry light";
    Renderer short_(device, scene, camera, imageOf(shot), settingsOf(shot));
    EXPECT_THROW(short_.trace(0, 0, 0, 0), Error);
    EXPECT_THROW(traced.trace(0, 16, 0, 0), Error);
}

Scene someRoom() {
    Scene scene;
    addMesh(scene, cubeMesh(true), matte({0.7f, 0.6f, 0.5f}, glm::vec3(0.1f)));
    addMesh(scene, sphereMesh(8), Material{}, glm::dmat4(glm::dmat3(0.4)));
    return scene;
}

TEST_F(HardSums, HardCase45_SameSeedSameBits) {
    const Scene scene = someRoom();
    const Camera camera = cameraAt({0, 0, 0.9}, {0.1, 0.2, -1}, 1.2);
    const Shot shot{.size = 40, .samples = 9, .maxBounces = 6};
    const Picture once = render(device, scene, camera, shot);
    EXPECT_TRUE(sameBits(render(device, scene, camera, shot), once));
    Shot other = shot;
    other.seed = 2;
    EXPECT_FALSE(sameBits(render(device, scene, camera, other), once));

    // Small tiles in another order, the passes through EXRs.
    ImageSpec image = imageOf(shot);
    image.tileSize = 16;
    Renderer renderer(device, scene, camera, image, settingsOf(shot));
    const TileGrid grid(image);
    std::vector<uint32_t> backwards(grid.count());
    std::iota(backwards.rbegin(), backwards.rend(), 0u);
    std::vector<FilmTile> tiles;
    for (uint32_t i = 0; i < grid.count(); ++i) tiles.emplace_back(grid.rect(i));
    for (const SampleRange& range : passSchedule(shot.samples)) {
        const auto films = renderer.render(0, backwards, range);
        for (const PassFilm& film : decodePassFilms(encodePassFilms(films, image, {})))
            tiles[film.tile].merge(film);
    }
    for (const FilmTile& tile : tiles)
        for (size_t i = 0; i < tile.pixels.size(); ++i) {
            const size_t at =
                (tile.rect.y + i / tile.rect.width) * shot.size + tile.rect.x + i % tile.rect.width;
            ASSERT_EQ(std::memcmp(&tile.pixels[i], &once.pixels[at], sizeof(FilmPixel)), 0) << at;
        }
}

TEST_F(HardSums, HardCase49_FramesAroundThePoles) {
    std::vector<glm::vec4> normals;
    RandomNumbers random(49);
    for (const float z : {1.0f, -1.0f}) {
        normals.emplace_back(0, 0, z, 0);
        normals.emplace_back(0, -0.0f, z, 0);
        for (int exponent = 3; exponent <= 8; ++exponent)
            for (int k = 0; k < 200; ++k) {
                const double tilt = std::pow(10.0, -exponent) * random.unit(),
                             phi = 6.2831853 * random.unit();
                normals.emplace_back(std::sin(tilt) * std::cos(phi), std::sin(tilt) * std::sin(phi),
                                     z * std::cos(tilt), 0);
            }
    }
    for (const float z : {0.0f, -0.0f, 1e-30f, -1e-30f}) normals.emplace_back(0.6f, 0.8f, z, 0);
    for (int k = 0; k < 5000; ++k) normals.emplace_back(random.direction(), 0);
    const auto frames =
        Probe(device).run(PROBE_FRAMES, static_cast<uint32_t>(normals.size()), normals, 3).values;
    double furthest = 0;
    for (size_t i = 0; i < normals.size(); ++i) {
        // The normals are unit only up to a rounding: what is judged is the frame, not they.
        const glm::dmat3 frame(glm::dvec3(frames[3 * i]), glm::dvec3(frames[3 * i + 1]),
                               glm::dvec3(frames[3 * i + 2]));
        const glm::dmat3 off = glm::transpose(frame) * frame - glm::dmat3(1);
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) furthest = std::max(furthest, std::abs(off[c][r]));
        furthest = std::max(furthest, std::abs(glm::determinant(frame) - 1));
        ASSERT_EQ(glm::vec3(frames[3 * i + 2]), glm::vec3(normals[i]));
    }
    EXPECT_LE(furthest, 1e-6);
    recordWorst("furthest", furthest);
    // Near a pole the tangent follows the normal: no jump between neighbours.
    for (size_t i = 2; i + 1 < 1202; ++i) {
        const double apart = glm::length(glm::dvec3(normals[i + 1]) - glm::dvec3(normals[i]));
        ASSERT_LE(glm::length(glm::dvec3(frames[3 * i + 3]) - glm::dvec3(frames[3 * i])), 2 * apart + 1e-6)
            << i;
    }
}

TEST_F(HardSums, HardCase49_NoSeamOnASphere) {
    // Where the frame's sign flips (normal.z = 0) and at both poles irradiance is what it is elsewhere.
    Scene scene;
    addMesh(scene, sphereMesh(48), matte(glm::vec3(0.8f)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    for (const glm::dvec3& from : {glm::dvec3(4, 0.1, 0), {0, 0.1, 4}, {0, 0.1, -4}}) {
        const Picture picture =
            render(device, scene, cameraAt(from, {0, 0, 0}, 0.2), {.size = 24, .samples = 32});
        // A mesh's smooth normals lean away from its flat triangles and lose 1e-3 of the light.
        expectMean(meanOf(picture), 0.8, 1e-3);
        Picture left = picture, right = picture;
        left.pixels.clear(), right.pixels.clear();
        for (size_t i = 0; i < picture.pixels.size(); ++i)
            (i % picture.width < picture.width / 2 ? left : right).pixels.push_back(picture.pixels[i]);
        expectSameMean(meanOf(left), meanOf(right), 1e-4);
    }
}

/// A sky that differs from row to row and around, but not between +z and −z.
Environment skyAlikeBeforeAndBehind() {
    Environment sky = uniformEnvironment(glm::vec3(0), 16, 8);
    for (uint32_t y = 0; y < 8; ++y)
        for (uint32_t x = 0; x < 16; ++x)
            for (size_t c = 0; c < 3; ++c)
                sky.image.rgbaFloat[4 * (y * 16 + x) + c] =
                    static_cast<float>(8 - y + std::min(x, 15 - x) % 3);
    return sky;
}

/// The frame turns where the normal's z changes its sign, down the middle of the picture; light of either
/// side is the same, at the seam as elsewhere.
void expectNoSeam(const gpu::Device& device, const Material& material, const Shot& shot) {
    Scene scene;
    addMesh(scene, sphereMesh(48), material);
    scene.environment = skyAlikeBeforeAndBehind();
    const Picture picture = render(device, scene, cameraAt({4, 0.1, 0}, {0, 0, 0}, 0.2), shot);
    const uint32_t half = shot.size / 2;
    for (const uint32_t width : {half, 1u}) {
        Picture before = picture, behind = picture;
        before.pixels.clear(), behind.pixels.clear();
        for (size_t i = 0; i < picture.pixels.size(); ++i) {
            const auto x = static_cast<uint32_t>(i % shot.size);
            if (x < half && x >= half - width) before.pixels.push_back(picture.pixels[i]);
            if (x >= half && x < half + width) behind.pixels.push_back(picture.pixels[i]);
        }
        expectSameMean(meanOf(before), meanOf(behind), 1e-4);
    }
}

TEST_F(HardSums, HardCase49_NoSeamUnderASkyThatVaries) {
    expectNoSeam(device, matte(glm::vec3(0.8f)), {.size = 24, .samples = 64});
}
TEST_F(HardSums, FullHardCase49_NoSeamUnderASkyThatVaries) {
    Material metal;
    metal.roughness = 0.5f;
    for (const Material& material : {matte(glm::vec3(0.8f)), metal})
        expectNoSeam(device, material, {.size = 64, .samples = 512});
}

TEST_F(HardSums, HardCase52_RunningMeanOfAMillionPasses) {
    FilmPixel pixel;
    PassPixel pass;
    pass.count = 256;
    const uint32_t passes = 1u << 20;
    // Pass k has the mean 1/3 + k/passes, exactly so in fp32: the mean of all is the closed form.
    for (uint32_t k = 0; k < passes; ++k) {
        const float mean = 0.5f + static_cast<float>(k) * 0x1p-20f;
        pass.mean = {mean, mean, mean};
        pixel.merge(pass, 256);
    }
    const double expected = 0.5 + 0.5 * (passes - 1.0) / passes;
    EXPECT_NEAR(pixel.mean[0], expected, 1e-12);
    EXPECT_EQ(pixel.count, 256.0 * passes);
    const double n = passes, m2 = 256 * n * (n * n - 1) / 12 * 0x1p-40;
    EXPECT_NEAR(pixel.m2[0], m2, 1e-9 * m2);
}

TEST_F(HardSums, HardCase52_RestartLeavesNoTrace) {
    // A renderer that has rendered other samples, tiles and frames gives the bits of a fresh one.
    const Scene scene = someRoom();
    const Camera camera = cameraAt({0, 0, 0.9}, {0.1, 0.2, -1}, 1.2);
    const Shot shot{.size = 24};
    const std::vector<uint32_t> tile{0};
    Renderer used(device, scene, camera, imageOf(shot), settingsOf(shot));
    (void)used.render(3, tile, {0, 8});
    (void)used.render(0, tile, {16, 16});
    Renderer fresh(device, scene, camera, imageOf(shot), settingsOf(shot));
    const auto a = used.render(0, tile, {4, 4}), b = fresh.render(0, tile, {4, 4});
    EXPECT_EQ(std::memcmp(a[0].pixels.data(), b[0].pixels.data(), a[0].pixels.size() * sizeof(PassPixel)), 0);
}

}  // namespace
}  // namespace tilefarm
