#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/store/rows.h"

namespace tilefarm {

/// Where a worker runs: its host, or itself if it does not say.
std::string machineOf(const WorkerHello& hello);
/// The process that a worker is a device of.
std::string sessionOf(const WorkerHello& hello);

/// Who asked for work lately and how fast each is. Lives in memory: a restarted server learns speeds
/// anew within a lease. Not thread safe; the scheduler guards it.
class WorkerRoster {
public:
    WorkerRoster(Milliseconds onlineFor, const std::vector<WorkerRow>& known);

    /// Notes that the worker is alive; true if its row should be stored (new, changed, or long ago).
    bool seen(const WorkerHello& hello, TimePoint now);
    void seen(const std::string& worker, TimePoint now);
    WorkerRow* find(const std::string& worker);
    size_t online(TimePoint now) const;
    /// Whether a worker is online on a machine that is not among these.
    bool onlineElsewhere(const std::vector<std::string>& machines, TimePoint now) const;
    /// Rows with the state of the moment: offline where not seen lately.
    std::vector<WorkerRow> list(TimePoint now) const;
    void forgetSeenBefore(TimePoint lastSeen);

    /// Pixel samples per device second of a worker on a job (moving average); 0 while unknown.
    double rate(const std::string& worker, JobKey job) const;
    /// On whatever it worked last.
    double lastRate(const std::string& worker) const;
    void measured(const std::string& worker, JobKey job, double samples, double deviceSeconds);

private:
    struct Speed {
        std::map<JobKey, double> rates;
        double last = 0;
    };
    bool isOnline(const WorkerRow& row, TimePoint now) const;

    Milliseconds onlineFor_;
    std::map<std::string, WorkerRow> workers_;
    std::map<std::string, TimePoint> stored_;
    std::map<std::string, Speed> speeds_;
};

}  // namespace tilefarm
