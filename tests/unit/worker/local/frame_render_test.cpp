#include "worker/local/frame_render.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "tests/unit/worker/agent/fakes.h"

namespace tilefarm {
namespace {

JobSpec job(uint32_t samples, uint32_t width = 40, uint32_t height = 24, uint32_t tileSize = 16) {
    JobSpec spec;
    spec.image = {width, height, tileSize};
    spec.stop.samples = samples;
    return spec;
}

// What the server does with the same passes: the films of each tile merged in sample order.
FilmTile merged(const JobSpec& spec, uint32_t tile) {
    FilmTile film(TileGrid(spec.image).rect(tile));
    for (const SampleRange samples : passSchedule(spec.stop.samples)) {
        PassFilm pass{tile, film.rect, samples, {}};
        for (uint32_t i = 0; i < film.rect.area(); ++i)
            pass.pixels.push_back(fakePixel(film.rect, i, samples));
        film.merge(pass);
    }
    return film;
}

TEST(FrameRender, MergesTheSamePassesAsTheFarmInTheSameOrder) {
    const JobSpec spec = job(200);
    FakeBackend backend;
    backend.image = spec.image;
    FakeClock clock;
    const RenderedFrame frame = renderFrame(backend, spec, 0, clock, {});
    ASSERT_EQ(frame.tiles.size(), 6u);
    for (uint32_t tile = 0; tile < 6; ++tile) {
        const FilmTile expected = merged(spec, tile);
        EXPECT_EQ(frame.tiles[tile].mergedSamples, 200u);
        EXPECT_EQ(std::memcmp(frame.tiles[tile].pixels.data(), expected.pixels.data(),
                              expected.pixels.size() * sizeof(FilmPixel)),
                  0);
    }
    EXPECT_EQ(frame.stats.samples, 40u * 24 * 200);
}

TEST(FrameRender, GoesLevelByLevelOverAllTiles) {
    const JobSpec spec = job(4);
    FakeBackend backend;
    backend.image = spec.image;
    FakeClock clock;
    renderFrame(backend, spec, 0, clock, {});
    using Call = FakeBackend::Call;
    const std::vector<uint32_t> all{0, 1, 2, 3, 4, 5};
    EXPECT_THAT(backend.calls, testing::ElementsAre(Call{all, {0, 1}}, Call{all, {1, 1}}, Call{all, {2, 2}}));
}

TEST(FrameRender, ASlowDeviceGetsFewerTilesInACall) {
    const JobSpec spec = job(64);
    FakeBackend backend;
    backend.image = spec.image;
    FakeClock clock;
    backend.onRender = [&] { clock.advance(Milliseconds(1000)); };
    renderFrame(backend, spec, 0, clock, {});
    EXPECT_EQ(backend.calls.front().tiles.size(), 6u);
    EXPECT_LT(backend.calls.back().tiles.size(), 6u);
    std::vector<uint32_t> lastLevel;
    for (const auto& call : backend.calls)
        if (call.samples.first == 32) lastLevel.insert(lastLevel.end(), call.tiles.begin(), call.tiles.end());
    EXPECT_THAT(lastLevel, testing::ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST(FrameRender, BoundsWhatACallHoldsInMemory) {
    const JobSpec spec = job(1, 2048, 1024, 512);
    FakeBackend backend;
    backend.image = spec.image;
    FakeClock clock;
    renderFrame(backend, spec, 0, clock, {});
    EXPECT_GE(backend.calls.size(), 2u);
    for (const auto& call : backend.calls) EXPECT_LE(call.tiles.size(), 4u);
}

TEST(FrameRender, GivesTheErrorAtPowersOfTwoAndAtTheEnd) {
    const JobSpec spec = job(100);
    FakeBackend backend;
    backend.image = spec.image;
    FakeClock clock;
    const RenderedFrame frame = renderFrame(backend, spec, 0, clock, {});
    std::vector<uint32_t> samples;
    for (const ErrorPoint& point : frame.errorCurve) samples.push_back(point.samples);
    EXPECT_THAT(samples, testing::ElementsAre(1, 2, 4, 8, 16, 32, 64, 100));
    EXPECT_FALSE(frame.errorCurve[0].relativeError.has_value());
    ErrorSums sums;
    for (const FilmTile& tile : frame.tiles) {
        ErrorSums ofTile;
        ofTile.add(tile);
        sums.add(ofTile);
    }
    EXPECT_EQ(frame.errorCurve.back().relativeError, sums.relativeError());
    ASSERT_TRUE(frame.errorCurve.back().estimate);
    EXPECT_EQ(frame.errorCurve.back().estimate->high, sums.estimate().high);
    EXPECT_NEAR(frame.errorCurve.back().deviceSeconds, 8 * 6 * 0.01, 1e-9);
}

TEST(FrameRender, GoesOnWithTheTilesThatTheDecisionsName) {
    JobSpec spec = job(512);
    spec.stop.relativeError = 0.02;
    spec.stop.minSamples = 4;
    FakeBackend backend;
    backend.image = spec.image;
    FakeClock clock;
    const RenderedFrame frame = renderFrame(backend, spec, 0, clock, {});
    EXPECT_EQ(frame.stopReason, StopReason::relativeError);
    EXPECT_LE(frame.errorCurve.back().relativeError, 0.02);
    uint64_t samples = 0;
    for (const FilmTile& tile : frame.tiles) samples += tile.rect.area() * tile.mergedSamples;
    EXPECT_EQ(frame.stats.samples, samples);
    EXPECT_EQ(frame.errorCurve.back().samples, samples / (40 * 24));
    // Every tile has a call for each of its passes, in order.
    std::vector<uint32_t> reached(6);
    for (const auto& call : backend.calls)
        for (const uint32_t tile : call.tiles)
            EXPECT_EQ(std::exchange(reached[tile], call.samples.end()), call.samples.first);
    for (uint32_t tile = 0; tile < 6; ++tile) EXPECT_EQ(reached[tile], frame.tiles[tile].mergedSamples);
}

TEST(FrameRender, EndsBeforeATimeLimit) {
    JobSpec spec = job(512);
    spec.stop.wallSeconds = 10;
    FakeBackend backend;
    backend.image = spec.image;
    FakeClock clock;
    backend.onRender = [&] {  // a sixth of a second for each sample of a tile
        const auto& call = backend.calls.back();
        clock.advance(Milliseconds(1000 * call.tiles.size() * call.samples.count / 6));
    };
    FrameProgress last;
    const RenderedFrame frame =
        renderFrame(backend, spec, 0, clock, [&](const FrameProgress& p) { last = p; });
    EXPECT_EQ(frame.stopReason, StopReason::wallSeconds);
    EXPECT_LE(frame.seconds, 10);
    EXPECT_EQ(frame.tiles[0].mergedSamples, frame.tiles[5].mergedSamples);
    EXPECT_EQ(last.samplesDone, last.samplesInAll);
    EXPECT_TRUE(last.wholeLevel);
}

TEST(FrameRender, TellsHowFarItIsAndWhatIsLeft) {
    const JobSpec spec = job(4);
    FakeBackend backend;
    backend.image = spec.image;
    FakeClock clock;
    backend.onRender = [&] { clock.advance(Milliseconds(500)); };
    std::vector<FrameProgress> seen;
    const RenderedFrame frame =
        renderFrame(backend, spec, 0, clock, [&](const FrameProgress& p) { seen.push_back(p); });
    ASSERT_EQ(seen.size(), 3u);
    EXPECT_EQ(seen[1].samplesDone, 40u * 24 * 2);
    EXPECT_EQ(seen[1].samplesInAll, 40u * 24 * 4);
    EXPECT_DOUBLE_EQ(seen[1].seconds, 1.0);
    EXPECT_DOUBLE_EQ(seen[1].secondsLeft, 1.0);
    EXPECT_DOUBLE_EQ(seen[2].secondsLeft, 0.0);
    EXPECT_DOUBLE_EQ(frame.seconds, 1.5);
}

}  // namespace
}  // namespace tilefarm
