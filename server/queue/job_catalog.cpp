#include "server/queue/job_catalog.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "shared/job/wire.h"

namespace tilefarm {
JobInfo::JobInfo(JobKey k, std::string i, JobSpec s)
    : key(k),
      id(std::move(i)),
      spec(std::move(s)),
      grid(spec.image),
      schedule(passSchedule(spec.stop.samples)),
      freeLevels(tilefarm::freeLevels(spec.stop, schedule)),
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

std::shared_ptr<const JobInfo> JobCatalog::find(JobKey key) {
    const std::scoped_lock lock(mutex_);
    const auto at = jobs_.find(key);
    if (at == jobs_.end()) return nullptr;
    byUse_.splice(byUse_.begin(), byUse_, at->second.use);
    return at->second.info;
}

void JobCatalog::keep(std::shared_ptr<const JobInfo> info, size_t bytes) {
    const std::scoped_lock lock(mutex_);
    const JobKey key = info->key;
    if (bytes > mostBytes_ || jobs_.contains(key)) return;
    for (; bytes_ + bytes > mostBytes_; byUse_.pop_back()) {
        bytes_ -= jobs_.at(byUse_.back()).bytes;
        jobs_.erase(byUse_.back());
    }
    byUse_.push_front(key);
    jobs_[key] = {std::move(info), bytes, byUse_.begin()};
    bytes_ += bytes;
}

// Parsed without the lock, which every request takes.
std::shared_ptr<const JobInfo> JobCatalog::get(const ConstTables& t, const JobRow& row) {
    if (auto known = find(row.key)) return known;
    const std::string spec = t.jobs.spec(row.key);
    auto info = std::make_shared<const JobInfo>(row.key, row.id, jobFromJson(parseJson(spec)));
    keep(info, spec.size());
    return info;
}

}  // namespace tilefarm
