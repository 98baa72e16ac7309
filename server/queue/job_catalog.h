#pragma once

#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/store/job_store.h"
#include "shared/film/sample_plan.h"
#include "shared/job/job.h"
#include "shared/job/pass_schedule.h"

namespace tilefarm {

/// What never changes about a job, parsed once.
struct JobInfo {
    JobKey key = 0;
    std::string id;
    JobSpec spec;
    TileGrid grid;
    std::vector<SampleRange> schedule;
    uint32_t freeLevels = 0;      // of the schedule, see shared/film/sample_plan.h
    std::vector<int32_t> frames;  // their numbers, in the order in which they are rendered

    JobInfo(JobKey key, std::string id, JobSpec spec);
    uint64_t passesPerFrame() const { return uint64_t{grid.count()} * schedule.size(); }
    uint64_t pixelSamplesPerFrame() const {
        return uint64_t{spec.image.width} * spec.image.height * spec.stop.samples;
    }
    uint64_t passes() const { return passesPerFrame() * spec.frames.count; }
    /// The index-th to be rendered.
    int32_t frame(uint32_t index) const { return frames[index]; }
    bool hasFrame(int32_t frame) const;
    /// The pass of the schedule that starts at this sample, or nullptr.
    const SampleRange* level(uint32_t first) const;
    /// The pass of the schedule that ends at this sample, or nullptr.
    const SampleRange* levelEnding(uint32_t end) const;

private:
    std::vector<int32_t> sortedFrames_;
};

/// Keeps the parsed form of the jobs in use: those used last, as many as fit. Any thread may call.
class JobCatalog {
public:
    /// `mostBytes`: of the texts that were parsed; the parsed forms take a few times as much.
    explicit JobCatalog(size_t mostBytes = 16u << 20) : mostBytes_(mostBytes) {}
    std::shared_ptr<const JobInfo> get(const ConstTables& t, const JobRow& row);

private:
    struct Kept {
        std::shared_ptr<const JobInfo> info;
        size_t bytes = 0;
        std::list<JobKey>::iterator use;
    };
    std::shared_ptr<const JobInfo> find(JobKey key);
    void keep(std::shared_ptr<const JobInfo> info, size_t bytes);

    const size_t mostBytes_;
    std::mutex mutex_;  // guards what follows
    std::map<JobKey, Kept> jobs_;
    std::list<JobKey> byUse_;  // the last used first
    size_t bytes_ = 0;
};

}  // namespace tilefarm
