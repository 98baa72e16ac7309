#include "server/queue/job_catalog.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "shared/job/wire.h"

namespace tilefarm {
namespace {
constexpr size_t kKept = 256;
}

JobInfo::JobInfo(JobKey k, std::string i, JobSpec s)
    : key(k),
      id(std::move(i)),
      spec(std::move(s)),
      grid(spec.image),
      schedule(passSchedule(spec.stop.samples)),
      frames(frameNumbers(spec.frames)),
      sortedFrames_(sortedFrameNumbers(spec.frames)) {}

bool JobInfo::hasFrame(int32_t frame) const {
    return std::binary_search(sortedFrames_.begin(), sortedFrames_.end(), frame);
}

const SampleRange* JobInfo::level(uint32_t first) const {
    const auto at =
        std::lower_bound(schedule.begin(), schedule.end(), first,
                         [](const SampleRange& range, uint32_t value) { return range.first < value; });
    return at != schedule.end() && at->first == first ? &*at : nullptr;
}

const SampleRange* JobInfo::levelEnding(uint32_t end) const {
    const auto at =
        std::lower_bound(schedule.begin(), schedule.end(), end,
                         [](const SampleRange& range, uint32_t value) { return range.end() < value; });
    return at != schedule.end() && at->end() == end ? &*at : nullptr;
}

std::shared_ptr<const JobInfo> JobCatalog::get(const JobRow& row) {
    const std::scoped_lock lock(mutex_);
    if (const auto at = jobs_.find(row.key); at != jobs_.end()) return at->second;
    auto info = std::make_shared<JobInfo>(row.key, row.id, jobFromJson(parseJson(row.specJson)));
    if (jobs_.size() >= kKept) jobs_.erase(jobs_.begin());  // the oldest job; parsed again if still used
    return jobs_[row.key] = std::move(info);
}

}  // namespace tilefarm
