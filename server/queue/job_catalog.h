#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/store/rows.h"
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
    std::vector<int32_t> frames;  // their numbers, in the order in which they are rendered

    JobInfo(JobKey key, std::string id, JobSpec spec);
    uint64_t passesPerFrame() const { return uint64_t{grid.count()} * schedule.size(); }
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

/// Keeps the parsed form of the jobs in use. Any thread may call.
class JobCatalog {
public:
    std::shared_ptr<const JobInfo> get(const JobRow& row);

private:
    std::mutex mutex_;
    std::map<JobKey, std::shared_ptr<const JobInfo>> jobs_;
};

}  // namespace tilefarm
