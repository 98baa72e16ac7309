#include "server/report/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>

#include "shared/job/lease.h"

namespace tilefarm {

using prometheus::Counter;
using prometheus::Gauge;

struct Metrics::Impl {
    prometheus::Registry registry;
    std::mutex scraping;

    Counter& counter(const char* name, const char* help, const prometheus::Labels& labels = {}) {
        return prometheus::BuildCounter().Name(name).Help(help).Register(registry).Add(labels);
    }
    Gauge& gauge(const char* name, const char* help, const prometheus::Labels& labels = {}) {
        return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add(labels);
    }

    Counter& leases = counter("tilefarm_leases_total", "Leases granted since the server started");
    Counter& results = counter("tilefarm_results_total", "Results accepted since the server started");
    Counter& resultBytes = counter("tilefarm_result_bytes_total", "Bytes of accepted results");
    Counter& merged = counter("tilefarm_result_passes_total", "Passes of results", {{"outcome", "merged"}});
    Counter& repeated =
        counter("tilefarm_result_passes_total", "Passes of results", {{"outcome", "already_merged"}});
    Counter& dropped =
        counter("tilefarm_dropped_samples_total", "Samples in results that were NaN or infinite");
    Counter& rejected = counter("tilefarm_rejected_paths_total",
                                "Paths in results that were rejected: a sampled direction of probability 0, "
                                "or too many nested solids");
    Counter& truncated = counter("tilefarm_truncated_paths_total",
                                 "Paths in results that maxBounces ended while their throughput was above 0");
    Counter& clamped = counter("tilefarm_clamped_samples_total",
                               "Samples in results that settings.clampDirect or clampIndirect clamped");
    Counter& failures = counter("tilefarm_failures_total", "Render errors that workers reported");
    Counter& violations = counter("tilefarm_sweep_violations_total", "Broken invariants that sweeps found");
    Gauge& openLeases = gauge("tilefarm_open_leases", "Leases that workers hold");
    Gauge& oldestQueued = gauge("tilefarm_oldest_queued_seconds", "Age of the oldest queued pass or job");
    Gauge& events = gauge("tilefarm_events", "Number of the newest event");
    prometheus::Family<Gauge>& passes = passFamily();
    prometheus::Family<Gauge>& jobs =
        prometheus::BuildGauge().Name("tilefarm_jobs").Help("Jobs by state").Register(registry);

    prometheus::Family<Gauge>& passFamily() {
        return prometheus::BuildGauge()
            .Name("tilefarm_passes")
            .Help("Passes of unfinished jobs by state; waiting ones have no row yet")
            .Register(registry);
    }
};

namespace {

struct PassTotals {
    double queued = 0, leased = 0, merged = 0, waiting = 0;
    std::optional<TimePoint> oldest;
};

// Of the jobs that hand out work. All counts are kept by the store.
PassTotals passTotals(const ConstTables& t, const std::map<JobState, JobTotals>& jobs) {
    PassTotals totals;
    for (const JobState state : {JobState::queued, JobState::running}) {
        const auto at = jobs.find(state);
        if (at == jobs.end()) continue;
        const JobTotals& of = at->second;
        totals.queued += static_cast<double>(of.passesQueued);
        totals.leased += static_cast<double>(of.passesLeased);
        totals.merged += static_cast<double>(of.passesMerged);
        totals.waiting += static_cast<double>(of.passes - of.passesMerged) -
                          static_cast<double>(of.passesQueued + of.passesLeased);
    }
    totals.oldest = t.passes.oldestQueued();
    if (const auto job = t.jobs.oldestQueued()) totals.oldest = std::min(totals.oldest.value_or(*job), *job);
    return totals;
}

}  // namespace

Metrics::Metrics() : impl_(std::make_unique<Impl>()) {}
Metrics::~Metrics() = default;

void Metrics::leases(uint64_t granted) {
    impl_->leases.Increment(static_cast<double>(granted));
}

void Metrics::result(const ResultReceipt& receipt, uint64_t bytes) {
    impl_->results.Increment();
    impl_->resultBytes.Increment(static_cast<double>(bytes));
    impl_->merged.Increment(receipt.merged);
    impl_->repeated.Increment(receipt.alreadyMerged);
}

void Metrics::faults(uint64_t droppedSamples, const PassFaults& faults) {
    impl_->dropped.Increment(static_cast<double>(droppedSamples));
    impl_->rejected.Increment(static_cast<double>(faults.rejectedPaths));
    impl_->truncated.Increment(static_cast<double>(faults.truncatedPaths));
    impl_->clamped.Increment(static_cast<double>(faults.clampedSamples));
}

void Metrics::failures(uint64_t reported) {
    impl_->failures.Increment(static_cast<double>(reported));
}
void Metrics::violations(uint64_t found) {
    impl_->violations.Increment(static_cast<double>(found));
}

std::string Metrics::text(const JobStore& store, size_t openLeases, TimePoint now) {
    const std::scoped_lock lock(impl_->scraping);
    store.read([&](const ConstTables& t) {
        const auto counts = t.jobs.totals();
        const PassTotals totals = passTotals(t, counts);
        impl_->passes.Add({{"state", "queued"}}).Set(totals.queued);
        impl_->passes.Add({{"state", "leased"}}).Set(totals.leased);
        impl_->passes.Add({{"state", "merged"}}).Set(totals.merged);
        impl_->passes.Add({{"state", "waiting"}}).Set(totals.waiting);
        for (const JobState state : {JobState::queued, JobState::running, JobState::paused,
                                     JobState::completed, JobState::failed, JobState::canceled}) {
            const auto at = counts.find(state);
            impl_->jobs.Add({{"state", std::string(toString(state))}})
                .Set(at == counts.end() ? 0 : static_cast<double>(at->second.jobs));
        }
        const auto age = totals.oldest ? now - *totals.oldest : Milliseconds{0};
        impl_->oldestQueued.Set(static_cast<double>(age.count()) / 1000);
        impl_->events.Set(static_cast<double>(t.events.lastId()));
    });
    impl_->openLeases.Set(static_cast<double>(openLeases));
    return prometheus::TextSerializer().Serialize(impl_->registry.Collect());
}

}  // namespace tilefarm
