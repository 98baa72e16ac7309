#include "server/film/result_merger.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "server/report/job_faults.h"
#include "shared/film/error_sums.h"
#include "shared/image/exr.h"
#include "tests/support/expect_error.h"
#include "tests/unit/server/support/test_farm.h"

namespace tilefarm {
namespace {

// Leases of one pass of each tile, so that a job is several uploads.
QueueConfig smallLeases() {
    QueueConfig config;
    config.mostPixelsPerLease = 6 * 16 * 16;
    return config;
}

std::vector<Lease> allLeases(TestFarm& farm) {
    std::vector<Lease> leases;
    while (auto lease = farm.tryLease()) leases.push_back(*lease);
    return leases;
}

size_t filesIn(const std::filesystem::path& folder) {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(ResultMerger, GivesTheSameFilmForAnyOrderOfResults) {
    const JobSpec spec = smallJob();
    const auto wanted = renderFrame(spec);
    std::vector<size_t> order{0, 1, 2, 3};
    do {
        TestFarm farm(smallLeases());
        const std::string id = farm.scheduler->submit(spec).job.id;
        const auto leases = allLeases(farm);
        ASSERT_EQ(leases.size(), 4u);
        for (const size_t i : order) EXPECT_EQ(farm.deliver(leases[i]).merged, 6u);
        EXPECT_TRUE(sameBits(farm.film(id), wanted)) << order[0] << order[1] << order[2] << order[3];
        EXPECT_EQ(farm.frame(id).state, FrameState::finishing);
        EXPECT_EQ(filesIn(farm.folder / "held"), 0u);
    } while (std::next_permutation(order.begin(), order.end()));
}

TEST(ResultMerger, GivesTheSameFurtherChannelsForAnyOrderOfResultsAndAfterAStart) {
    JobSpec spec = smallJob();
    spec.output = {true, true, true};
    const auto wanted = renderFrame(spec);
    EXPECT_EQ(wanted[0].extra.size(), 16u * 16 * 53);
    for (const std::vector<size_t>& order : {std::vector<size_t>{0, 1, 2, 3}, {3, 2, 1, 0}, {1, 3, 0, 2}}) {
        TestFarm farm(smallLeases());
        const std::string id = farm.scheduler->submit(spec).job.id;
        const auto leases = allLeases(farm);
        ASSERT_EQ(leases.size(), 4u);
        for (const size_t i : order) {
            EXPECT_EQ(farm.deliver(leases[i]).merged, 6u);
            farm.reopen();
        }
        EXPECT_TRUE(sameBits(farm.film(id), wanted));
    }
}

TEST(ResultMerger, RefusesFurtherChannelsThatAreNotTheJobs) {
    TestFarm farm(smallLeases());
    JobSpec spec = smallJob();
    spec.output.uv = true;
    farm.scheduler->submit(spec);
    Lease lease = farm.lease();
    lease.spec.output = {};
    const Error less = errorOf([&] { farm.deliver(lease); });
    EXPECT_EQ(less.code, ErrorCode::unprocessable);
    EXPECT_STREQ(less.what(),
                 "the part of tile 0, samples 0+1 has the additional channels none, but the job's are uv");
    lease.spec.output = {false, true, true};
    EXPECT_EQ(codeOf([&] { farm.deliver(lease); }), ErrorCode::unprocessable);
    lease.spec.output = spec.output;
    auto films = renderLease(lease);
    films[3].extra[7] = std::nanf("");
    EXPECT_EQ(codeOf([&] { farm.deliver(lease, films); }), ErrorCode::unprocessable);
    EXPECT_EQ(farm.deliver(lease).merged, 6u);
}

TEST(ResultMerger, TakesAnEarlyPassDurablyAndMergesItInItsTurn) {
    TestFarm farm(smallLeases());
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    const auto leases = allLeases(farm);
    EXPECT_EQ(farm.deliver(leases[1]).merged, 6u);
    EXPECT_EQ(farm.job(id).passesMerged, 6u);
    EXPECT_EQ(farm.film(id)[0].mergedSamples, 0u);
    farm.reopen();
    EXPECT_EQ(farm.deliver(leases[0]).merged, 6u);
    EXPECT_EQ(farm.film(id)[0].mergedSamples, 2u);
}

TEST(ResultMerger, CountsARepeatedResultOnce) {
    TestFarm farm(smallLeases());
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    const Lease lease = farm.lease();
    EXPECT_EQ(farm.deliver(lease, renderLease(lease), 2.5), (ResultReceipt{6, 0}));
    const auto before = farm.film(id);
    EXPECT_EQ(farm.deliver(lease, renderLease(lease), 2.5), (ResultReceipt{0, 6}));
    EXPECT_TRUE(sameBits(farm.film(id), before));
    EXPECT_EQ(farm.job(id).deviceSeconds, 2.5);
    EXPECT_EQ(farm.job(id).passesMerged, 6u);
}

TEST(ResultMerger, AcceptsALateResultThatIsStillNeeded) {
    TestFarm farm(smallLeases());
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    const Lease late = farm.lease("slow");
    farm.clock.advance(farm.config.leaseTime + Milliseconds(1));
    const Lease again = farm.lease("fast");
    EXPECT_EQ(again.passes, late.passes);
    EXPECT_EQ(farm.deliver(late), (ResultReceipt{6, 0}));
    EXPECT_EQ(farm.deliver(again), (ResultReceipt{0, 6}));
    EXPECT_EQ(farm.frame(id).passesLeased, 0u);
    farm.finish();
    EXPECT_EQ(farm.job(id).state, JobState::completed);
}

TEST(ResultMerger, MeasuresProgressInSamplesRatherThanPasses) {
    TestFarm farm(smallLeases());
    const std::string id = farm.scheduler->submit(smallJob(8)).job.id;
    for (const double fraction : {0.125, 0.25, 0.5, 1.0}) {
        farm.deliver(farm.lease());
        EXPECT_DOUBLE_EQ(farm.job(id).fractionDone(), fraction);
    }
}

TEST(ResultMerger, RefusesWhatIsNotOfTheLease) {
    TestFarm farm(smallLeases());
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    const Lease lease = farm.lease();
    const auto refused = [&](const std::function<void(std::vector<PassFilm>&)>& spoil) {
        auto films = renderLease(lease);
        spoil(films);
        return codeOf([&] { farm.deliver(lease, films); });
    };
    EXPECT_EQ(refused([](auto& films) { films.push_back(films[0]); }), ErrorCode::unprocessable);
    EXPECT_EQ(refused([](auto& films) { films[0].samples = {1, 1}; }), ErrorCode::unprocessable);
    EXPECT_EQ(refused([](auto& films) { films[0].samples.count = 2; }), ErrorCode::unprocessable);
    EXPECT_EQ(refused([](auto& films) { films[0].tile = 77; }), ErrorCode::unprocessable);
    EXPECT_EQ(refused([](auto& films) { films[0].rect.x = 1; }), ErrorCode::unprocessable);
    EXPECT_EQ(refused([](auto& films) { films[5].pixels[3].mean[1] = NAN; }), ErrorCode::unprocessable);
    EXPECT_EQ(refused([](auto& films) { films.clear(); }), ErrorCode::unprocessable);
    EXPECT_EQ(farm.job(id).passesMerged, 0u);
    EXPECT_EQ(farm.deliver(lease).merged, 6u);
}

TEST(ResultMerger, PutsBackWhatAPartialResultLeftOut) {
    TestFarm farm(smallLeases());
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    const Lease lease = farm.lease();
    auto films = renderLease(lease);
    films.resize(2);
    EXPECT_EQ(farm.deliver(lease, films).merged, 2u);
    EXPECT_EQ(farm.frame(id).passesLeased, 0u);
    farm.finish();
    EXPECT_EQ(farm.job(id).state, JobState::completed);
}

TEST(ResultMerger, SaysWhichShareOfTheLightClampsRemoved) {
    JobSpec spec = smallJob();
    const auto percentOf = [&](const TestFarm& farm, const std::string& id) {
        return numericsOf(farm.job(id)).at("clampedPercent").get<double>();
    };
    double luminance = 0;
    for (const FilmTile& tile : renderFrame(spec))
        for (const FilmPixel& pixel : tile.pixels) luminance += pixel.count * pixel.luminance();
    for (const double bound : {0.0, 2.0}) {
        spec.settings.clampIndirect = bound;
        TestFarm farm(smallLeases());
        const std::string id = farm.scheduler->submit(spec).job.id;
        EXPECT_EQ(percentOf(farm, id), 0);
        for (const Lease& lease : allLeases(farm)) {
            auto films = renderLease(lease);
            if (bound > 0) films[0].faults.clampedLuminance = luminance / 16;  // of four leases each
            farm.deliver(lease, films);
            farm.deliver(lease, films);  // a repeated upload counts once
        }
        EXPECT_NEAR(percentOf(farm, id), bound > 0 ? 20 : 0, 1e-4);
    }
}

TEST(ResultMerger, RefusesResultsOfAnEndedJob) {
    TestFarm farm(smallLeases());
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    const Lease lease = farm.lease();
    farm.scheduler->cancel(id);
    EXPECT_EQ(codeOf([&] { farm.deliver(lease); }), ErrorCode::gone);
}

TEST(ResultMerger, RecordsTheErrorOfEveryLevelWhateverTheOrder) {
    const JobSpec spec = smallJob();
    const TileGrid grid(spec.image);
    TestFarm farm(smallLeases());
    const std::string id = farm.scheduler->submit(spec).job.id;
    auto leases = allLeases(farm);
    std::reverse(leases.begin(), leases.end());
    for (const Lease& lease : leases) farm.deliver(lease, renderLease(lease), 0.5);

    std::vector<LevelRow> levels;
    farm.store->read([&](const ConstTables& t) { levels = t.frames.levels(farm.job(id).key, 0); });
    ASSERT_EQ(levels.size(), 4u);
    EXPECT_EQ(levels[0].samples, 1u);
    EXPECT_EQ(levels[0].relativeError, std::nullopt);  // one sample has no variance
    ErrorSums sums;
    for (const FilmTile& tile : renderFrame(spec)) sums.add(tile);
    EXPECT_NEAR(*levels[3].relativeError, sums.relativeError(), 1e-12);
    EXPECT_NEAR(levels[3].errorSquares, sums.squares, 1e-12 * sums.squares);
    EXPECT_NEAR(levels[3].borrowedVariance, sums.borrowed, 1e-12 * sums.borrowed);
    EXPECT_EQ(levels[3].errorTail.worst(), sums.tail.worst());
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(levels[i].errorTail, ErrorTail()) << "kept for the last alone";
    EXPECT_DOUBLE_EQ(*levels[3].deviceSeconds, 2.0);
    EXPECT_TRUE(std::is_sorted(levels.begin(), levels.end(), [](const auto& a, const auto& b) {
        return *a.deviceSeconds < *b.deviceSeconds;
    }));
}

TEST(ResultMerger, SharesTheSecondsOfALeaseAmongItsLevels) {
    TestFarm farm;
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    const Lease lease = farm.lease();
    ASSERT_EQ(lease.passes.size(), 24u);
    farm.deliver(lease, renderLease(lease), 8);
    farm.store->read([&](const ConstTables& t) {
        const auto levels = t.frames.levels(farm.job(id).key, 0);
        ASSERT_EQ(levels.size(), 4u);
        for (const LevelRow& level : levels) EXPECT_DOUBLE_EQ(*level.deviceSeconds, level.samples);
    });
}

// Stops a merge after each of its durable steps, as a crash would, and starts again.
class MergeCrash : public testing::TestWithParam<const char*> {};

TEST_P(MergeCrash, LosesAndDoublesNothing) {
    const JobSpec spec = smallJob();
    TestFarm farm(smallLeases());
    const std::string id = farm.scheduler->submit(spec).job.id;
    std::vector<Lease> leases;
    for (int i = 0; i < 4; ++i) leases.push_back(farm.lease());
    std::swap(leases[1], leases[2]);  // so that one comes early

    for (const Lease& lease : leases) {
        farm.probe = [](std::string_view step) {
            if (step == GetParam()) throw std::runtime_error("crash");
        };
        EXPECT_THROW(farm.deliver(lease, renderLease(lease), 1.5), std::runtime_error);
        farm.probe = nullptr;
        farm.reopen();
        EXPECT_TRUE(farm.scheduler->sweep().empty());
        farm.deliver(lease, renderLease(lease), 1.5);  // the worker never heard an answer
    }
    EXPECT_TRUE(sameBits(farm.film(id), renderFrame(spec)));
    EXPECT_EQ(farm.job(id).passesMerged, 24u);
    EXPECT_DOUBLE_EQ(farm.job(id).deviceSeconds, 6);
    farm.finish();
    EXPECT_EQ(farm.job(id).state, JobState::completed);
}

INSTANTIATE_TEST_SUITE_P(AfterEachStep, MergeCrash,
                         testing::Values("slots written", "slots synced", "early passes held", "committed"));

TEST(ResultMerger, IsNotHarmedByGarbageInTheSlotNotInForce) {
    TestFarm farm(smallLeases());
    const JobSpec spec = smallJob();
    const std::string id = farm.scheduler->submit(spec).job.id;
    const auto leases = allLeases(farm);
    farm.deliver(leases[0]);
    std::vector<TileRow> rows;
    farm.store->read([&](const ConstTables& t) { rows = t.frames.tiles(farm.job(id).key, 0); });
    const auto info = farm.info(id);
    FilmFile file = farm.films->open(*info, 0);
    for (const TileRow& row : rows) {  // what a torn write of an unfinished merge may leave
        FilmTile garbage(info->grid.rect(row.tile));
        for (FilmPixel& pixel : garbage.pixels) pixel.mean = {NAN, INFINITY, -1};
        file.write(row.tile, 1 - row.slot, garbage);
    }
    for (size_t i = 1; i < leases.size(); ++i) farm.deliver(leases[i]);
    EXPECT_TRUE(sameBits(farm.film(id), renderFrame(spec)));
}

TEST(ResultMerger, NoticesAFilmThatIsNotTheDatabases) {
    TestFarm farm(smallLeases());
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    const auto leases = allLeases(farm);
    farm.deliver(leases[0]);
    const auto info = farm.info(id);
    FilmTile other(info->grid.rect(0));
    other.mergedSamples = 99;
    FilmFile file = farm.films->open(*info, 0);
    for (const uint32_t slot : {0u, 1u}) file.write(0, slot, other);
    EXPECT_EQ(codeOf([&] { farm.deliver(leases[1]); }), ErrorCode::internal);
}

}  // namespace
}  // namespace tilefarm
