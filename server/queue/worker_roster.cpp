#include "server/queue/worker_roster.h"

#include <algorithm>

namespace tilefarm {
namespace {
constexpr double kWeightOfNewest = 0.5;  // first dispatches are slow: old measurements must fade fast
constexpr size_t kJobsRemembered = 16;
constexpr Milliseconds kStoreEvery{60000};
}  // namespace

std::string machineOf(const WorkerHello& hello) {
    return hello.host.empty() ? hello.worker : hello.host;
}

std::string sessionOf(const WorkerHello& hello) {
    return hello.session.empty() ? hello.worker : hello.session;
}

WorkerRoster::WorkerRoster(Milliseconds onlineFor, const std::vector<WorkerRow>& known)
    : onlineFor_(onlineFor) {
    for (const WorkerRow& row : known) workers_[row.hello.worker] = row;
}

bool WorkerRoster::seen(const WorkerHello& hello, TimePoint now) {
    auto [at, isNew] = workers_.try_emplace(hello.worker);
    WorkerRow& row = at->second;
    const bool changed = isNew || row.hello != hello;
    if (isNew) row.firstSeen = now;
    row.hello = hello;
    row.lastSeen = now;
    if (!changed && now - stored_[hello.worker] < kStoreEvery) return false;
    stored_[hello.worker] = now;
    return true;
}

void WorkerRoster::seen(const std::string& worker, TimePoint now) {
    if (WorkerRow* row = find(worker)) row->lastSeen = now;
}

WorkerRow* WorkerRoster::find(const std::string& worker) {
    const auto at = workers_.find(worker);
    return at == workers_.end() ? nullptr : &at->second;
}

bool WorkerRoster::isOnline(const WorkerRow& row, TimePoint now) const {
    return row.state == WorkerState::online && now - row.lastSeen < onlineFor_;
}

size_t WorkerRoster::online(TimePoint now) const {
    return static_cast<size_t>(std::count_if(workers_.begin(), workers_.end(),
                                             [&](const auto& at) { return isOnline(at.second, now); }));
}

bool WorkerRoster::onlineElsewhere(const std::vector<std::string>& machines, TimePoint now) const {
    return std::any_of(workers_.begin(), workers_.end(), [&](const auto& at) {
        return isOnline(at.second, now) &&
               std::find(machines.begin(), machines.end(), machineOf(at.second.hello)) == machines.end();
    });
}

std::vector<WorkerRow> WorkerRoster::list(TimePoint now) const {
    std::vector<WorkerRow> rows;
    for (const auto& [id, row] : workers_) {
        rows.push_back(row);
        if (row.state == WorkerState::online && !isOnline(row, now)) rows.back().state = WorkerState::offline;
    }
    return rows;
}

void WorkerRoster::forgetSeenBefore(TimePoint lastSeen) {
    std::erase_if(workers_, [&](const auto& at) { return at.second.lastSeen < lastSeen; });
    std::erase_if(speeds_, [&](const auto& at) { return !workers_.contains(at.first); });
    std::erase_if(stored_, [&](const auto& at) { return !workers_.contains(at.first); });
}

double WorkerRoster::rate(const std::string& worker, JobKey job) const {
    const auto at = speeds_.find(worker);
    if (at == speeds_.end()) return 0;
    const auto rate = at->second.rates.find(job);
    return rate == at->second.rates.end() ? 0 : rate->second;
}

double WorkerRoster::lastRate(const std::string& worker) const {
    const auto at = speeds_.find(worker);
    return at == speeds_.end() ? 0 : at->second.last;
}

void WorkerRoster::measured(const std::string& worker, JobKey job, double samples, double deviceSeconds) {
    if (!(samples > 0) || !(deviceSeconds > 0)) return;
    Speed& speed = speeds_[worker];
    if (speed.rates.size() >= kJobsRemembered && !speed.rates.contains(job))
        speed.rates.erase(speed.rates.begin());
    double& rate = speed.rates[job];
    const double newest = samples / deviceSeconds;
    rate = rate > 0 ? rate + (newest - rate) * kWeightOfNewest : newest;
    speed.last = rate;
}

}  // namespace tilefarm
