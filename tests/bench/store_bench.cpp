// What the queue's hot queries cost in a farm with many jobs and frames of many tiles.
//   build/release/bin/tilefarm_store_bench
#include <benchmark/benchmark.h>

#include <map>
#include <memory>

#include "server/store/sqlite_job_store.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

constexpr TimePoint kNow{Milliseconds{1'700'000'000'000}};
constexpr uint32_t kHeldTiles = 16;

// `jobs` jobs that wait; the first has a frame of `tiles` tiles, a few of which hold an early pass.
struct Farm {
    TemporaryFolder folder;
    SqliteJobStore store{folder / "db"};
    JobKey first = 0;

    Farm(int64_t jobs, uint32_t tiles) {
        store.write([&](Tables& t) {
            for (int64_t i = 0; i < jobs; ++i) addJob(t, i);
            addFrame(t, tiles);
        });
    }
    void addJob(Tables& t, int64_t number) {
        JobRow row;
        row.id = "j" + std::to_string(number);
        row.priority = static_cast<int32_t>(number * 37 % 101);
        row.outlineJson = std::string(1500, ' ');  // about what a job's text takes
        row.passes = row.frames = row.pixelSamples = 1;
        const JobKey key = t.jobs.insert(row, row.outlineJson);
        if (first == 0) first = key;
    }
    void addFrame(Tables& t, uint32_t tiles) {
        FrameRow frame;
        frame.job = first;
        frame.levels = 2;
        frame.tiles = tiles;
        t.frames.insert(frame);
        for (uint32_t level : {0u, 1u}) t.passes.insertLevel(first, 0, {level, 1}, tiles, kNow);
        for (uint32_t tile = 0; tile < std::min(kHeldTiles, tiles); ++tile) {
            PassRow row = *t.passes.find(first, 0, tile, 1);
            row.state = PassState::merged;
            row.held = HeldPass{"file" + std::to_string(tile), 0};
            t.passes.update(row);
        }
    }
};

// Made once for each size: the benchmarks run many times.
Farm& farmWith(int64_t jobs, uint32_t tiles) {
    static std::map<std::pair<int64_t, uint32_t>, std::unique_ptr<Farm>> farms;
    auto& farm = farms[{jobs, tiles}];
    if (!farm) farm = std::make_unique<Farm>(jobs, tiles);
    return *farm;
}

void FirstJobWithWork(benchmark::State& state) {
    Farm& farm = farmWith(state.range(0), 1);
    farm.store.read([&](const ConstTables& t) {
        for ([[maybe_unused]] auto _ : state) t.jobs.forEachLeasable([](JobKey) { return false; });
    });
}
BENCHMARK(FirstJobWithWork)->Arg(30)->Arg(3000)->Unit(benchmark::kMillisecond);

void EarlyPassesOfATile(benchmark::State& state) {
    Farm& farm = farmWith(1, static_cast<uint32_t>(state.range(0)));
    farm.store.read([&](const ConstTables& t) {
        for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(t.passes.heldOf(farm.first, 0, 7));
    });
}
BENCHMARK(EarlyPassesOfATile)->Arg(1024)->Arg(262144)->Unit(benchmark::kMillisecond);

void FileWithEarlyPasses(benchmark::State& state) {
    Farm& farm = farmWith(1, static_cast<uint32_t>(state.range(0)));
    farm.store.read([&](const ConstTables& t) {
        for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(t.passes.isHeld("file7"));
    });
}
BENCHMARK(FileWithEarlyPasses)->Arg(1024)->Arg(262144)->Unit(benchmark::kMillisecond);

void OldestQueued(benchmark::State& state) {  // once for each scrape of the metrics
    Farm& farm = farmWith(1, static_cast<uint32_t>(state.range(0)));
    farm.store.read([&](const ConstTables& t) {
        for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(t.passes.oldestQueued());
    });
}
BENCHMARK(OldestQueued)->Arg(1024)->Arg(262144)->Unit(benchmark::kMillisecond);

// What one lease costs without the disk: everything in one transaction, which is not committed in between.
void LeaseOfFourPasses(benchmark::State& state) {
    Farm& farm = farmWith(1, static_cast<uint32_t>(state.range(0)));
    farm.store.write([&](Tables& t) {
        uint64_t epoch = t.leases.lastEpoch();
        for ([[maybe_unused]] auto _ : state) {
            LeaseRow lease{.epoch = ++epoch,
                           .id = std::to_string(epoch),
                           .worker = "w",
                           .job = farm.first,
                           .passes = {}};
            lease.passes = t.passes.claim(
                {.job = farm.first, .frame = 0, .epoch = epoch, .level = {0, 1}, .limit = 4, .worker = "w"});
            t.leases.insert(lease);
            t.frames.update(*t.frames.find(farm.first, 0));
            t.jobs.update(*t.jobs.find(farm.first));
            t.passes.release(epoch, kNow);
            t.leases.close(epoch, LeaseState::returned);
        }
    });
}
BENCHMARK(LeaseOfFourPasses)->Arg(1024)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tilefarm

BENCHMARK_MAIN();
