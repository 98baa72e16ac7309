#pragma once

#include <memory>
#include <string>

#include "server/store/job_store.h"
#include "shared/film/film.h"

namespace tilefarm {

struct ResultReceipt;

/// Counters of this process and gauges read from the store, in Prometheus' text format. Any thread
/// may call.
class Metrics {
public:
    Metrics();
    ~Metrics();
    void leases(uint64_t granted);
    void result(const ResultReceipt& receipt, uint64_t bytes);
    /// Of a result that was received, whether or not its passes were merged before.
    void faults(uint64_t droppedSamples, const PassFaults& faults);
    void failures(uint64_t reported);
    void violations(uint64_t found);
    std::string text(const JobStore& store, size_t openLeases, TimePoint now);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm
