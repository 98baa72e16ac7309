#pragma once

#include <gtest/gtest.h>

#include "server/queue/scheduler.h"
#include "tests/support/expect_error.h"
#include "tests/support/fake_clock.h"
#include "tests/support/memory_job_store.h"
#include "tests/unit/server/support/test_farm.h"

namespace tilefarm {

/// The scheduler over rows in memory. `restart` forgets all that is not in the store.
class SchedulerTest : public testing::Test {
protected:
    SchedulerTest() { restart(); }
    void restart() { scheduler = std::make_unique<Scheduler>(store, clock, config); }
    void configure(const QueueConfig& c) {
        config = c;
        restart();
    }

    std::string submit(const JobSpec& spec = smallJob()) { return scheduler->submit(spec).job.id; }
    std::optional<Lease> tryLease(const std::string& worker = "w", double seconds = 5) {
        auto answer = scheduler->lease(hello(worker), seconds);
        if (auto* lease = std::get_if<Lease>(&answer)) return std::move(*lease);
        return std::nullopt;
    }
    Lease lease(const std::string& worker = "w", double seconds = 5) {
        return tryLease(worker, seconds).value();
    }
    JobRow job(const std::string& id) const {
        JobRow row;
        store.read([&](const ConstTables& t) { row = t.jobs.find(id).value(); });
        return row;
    }
    FrameRow frame(const std::string& id, int32_t number = 0) const {
        FrameRow row;
        store.read([&](const ConstTables& t) { row = t.frames.find(t.jobs.find(id)->key, number).value(); });
        return row;
    }
    /// Commits every pass of a lease whose film needs no file: sample order is the caller's care.
    ResultReceipt merge(const Lease& lease, double deviceSeconds = 1) {
        const auto target = scheduler->resultTarget(lease.id, lease.epoch);
        ResultMerge result;
        result.deviceSeconds = deviceSeconds;
        std::map<uint32_t, TileMerge> tiles;
        for (const LeasedPass& pass : lease.passes) {
            auto [at, isNew] = tiles.try_emplace(pass.tile);
            TileMerge& tile = at->second;
            if (isNew) {
                store.read([&](const ConstTables& t) {
                    tile.before = t.frames.tile(target.job->key, lease.frame, pass.tile).value();
                });
                tile.after = tile.before;
                tile.after.slot = 1 - tile.before.slot;
            }
            tile.after.mergedSamples = pass.samples.end();
            tile.merged.push_back(pass.samples.first);
            tile.levels.push_back({.samples = pass.samples.end(), .relativeError = {}, .deviceSeconds = {}});
            result.uploadedSamples += target.job->grid.rect(pass.tile).area() * pass.samples.count;
        }
        for (auto& [index, tile] : tiles) result.tiles.push_back(std::move(tile));
        return scheduler->commit(target, result);
    }

    FakeClock clock;
    QueueConfig config;
    MemoryJobStore store;
    std::unique_ptr<Scheduler> scheduler;
};

}  // namespace tilefarm
