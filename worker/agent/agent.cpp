#include "worker/agent/agent.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "shared/job/wire.h"
#include "worker/blob_cache/scene_folder.h"

namespace tilefarm {
namespace {

constexpr Milliseconds kFirstWait{250}, kLongestWait{5'000};
// Short: the next lease may well be of a job that is sound.
constexpr Milliseconds kFirstFailureWait{250}, kLongestFailureWait{2'000};
constexpr Milliseconds kHoldLeasing{60'000};
constexpr uint32_t kFewTries = 8;

// The lease cannot be worked on, through no fault of it: not a failure.
struct Abandoned {};

// Messages leave this machine: the folder a scene was laid out in says nothing to anybody else.
std::string withoutFolder(std::string message, const std::filesystem::path& folder) {
    const std::string prefix = folder.string() + "/";
    for (size_t at = 0; (at = message.find(prefix, at)) != std::string::npos;)
        message.erase(at, prefix.size());
    return message;
}

ImageAttributes attributesOf(const Lease& lease, const WorkerHello& hello) {
    return {{"job", lease.jobId},     {"frame", fmt::to_string(lease.frame)},
            {"worker", hello.worker}, {"device", hello.device},
            {"driver", hello.driver}, {"version", hello.version}};
}

}  // namespace

// All but what says when, how much and for whom; another frame of the same job is at hand in no time.
std::string residentKey(const JobSpec& spec) {
    nlohmann::json json = toJson(spec);
    for (const char* member : {"name", "frames", "stop", "priority"}) json.erase(member);
    return json.dump();
}

Agent::Agent(Parts parts, WorkerHello hello, double wantSeconds, uint32_t seed)
    : with_(parts),
      hello_(std::move(hello)),
      wantSeconds_(wantSeconds),
      away_(kFirstWait, kLongestWait, seed),
      failures_(kFirstFailureWait, kLongestFailureWait, seed + 1) {}

void Agent::run() {
    while (!with_.pause.stopping() && !with_.standing.stopped()) step();
}

void Agent::step() {
    if (!residentJob_.empty() && with_.standing.isGone(residentJob_)) letGo();
    const Milliseconds held = with_.standing.leasingHeldUntil() - with_.clock.now();
    if (held > Milliseconds(0)) return with_.pause.waitFor(held);
    const std::optional<Lease> lease = askForWork();
    if (!lease) return;
    const auto kept = with_.keeper.hold(*lease);
    try {
        work(*lease, kept);
        return;  // the Uploader lets go of the lease
    } catch (const Abandoned&) {
        if (kept->state == LeaseValidity::valid) {
            handBack(*kept);
            with_.pause.waitFor(failures_.next());  // the same lease may come back at once
        }
    } catch (const std::exception& error) {
        spdlog::error("job {}: {}", lease->jobId, error.what());
        letGo();
        with_.backend.reset();
        reportFailure(*kept, error.what());
        with_.keeper.release(*kept);
        return with_.pause.waitFor(failures_.next());
    }
    with_.keeper.release(*kept);
}

std::optional<Lease> Agent::askForWork() {
    try {
        auto answer = with_.farm.lease(hello_, wantSeconds_);
        if (away_.failures() > 0) spdlog::info("the server is back");
        away_.reset();
        if (const auto* lease = std::get_if<Lease>(&answer)) return *lease;
        with_.pause.waitFor(away_.jittered(Milliseconds(std::get<NoWork>(answer).retryAfterMs)));
    } catch (const Error& error) {
        if (away_.failures() == 0) spdlog::warn("{}: {}", toString(Endpoint::lease), error.what());
        switch (actionFor(Endpoint::lease, error.code)) {
            case Action::stop: with_.standing.mustStop(error.what()); break;
            case Action::hold: with_.standing.holdLeasing(with_.clock.now() + kHoldLeasing); break;
            default: with_.pause.waitFor(away_.next());
        }
    }
    return std::nullopt;
}

void Agent::work(const Lease& lease, const std::shared_ptr<HeldLease>& held) {
    makeResident(lease, *held);
    reportScene(lease);
    const double before = with_.backend.stats().deviceSeconds;
    std::vector<PassFilm> films = renderPasses(lease, *held);
    finish(lease, held, std::move(films), with_.backend.stats().deviceSeconds - before);
    failures_.reset();
}

void Agent::makeResident(const Lease& lease, const HeldLease& held) {
    std::string key = residentKey(lease.spec);
    if (key != residentKey_) {
        letGo();
        resident_ = prepare(lease, held);
        residentKey_ = std::move(key);
        spdlog::info("job {}: {} triangles, ready after {:.2f} s", lease.jobId, resident_.counts.triangles,
                     resident_.seconds());
    }
    residentJob_ = lease.jobId;
}

PreparedScene Agent::prepare(const Lease& lease, const HeldLease& held) {
    const BlobSource source = [this](const std::string& sha256, const std::filesystem::path& file) {
        with_.farm.getBlob(sha256, file);
    };
    away_.reset();
    std::optional<SceneFolder> folder;
    while (!folder) {
        try {
            folder.emplace(with_.cache, lease.spec.scene, source);
        } catch (const Error& error) {
            const Action action = actionFor(Endpoint::blob, error.code);
            if (action == Action::stop) with_.standing.mustStop(error.what());
            if (action == Action::dropJob) with_.standing.jobGone(lease.jobId);
            if (action == Action::hold) with_.standing.holdLeasing(with_.clock.now() + kHoldLeasing);
            const bool again =
                action == Action::retry || (action == Action::retryFew && away_.failures() < kFewTries);
            if (!again && (action == Action::refused || action == Action::retryFew)) throw;
            if (!again || !mayGoOn(held)) throw Abandoned();
            if (away_.failures() == 0) spdlog::warn("{}: {}", toString(Endpoint::blob), error.what());
            with_.pause.waitFor(away_.next());
        }
    }
    away_.reset();
    try {
        return with_.backend.prepare(lease.spec, {folder->entry(), folder->environment()});
    } catch (const Error& error) {
        throw Error(error.code, withoutFolder(error.what(), folder->path()));
    }
}

// Once for each job; a server that does not hear it renders just the same.
void Agent::reportScene(const Lease& lease) {
    if (!reportedJobs_.insert(lease.jobId).second) return;
    for (const SceneWarning& warning : resident_.warnings)
        spdlog::warn("job {}: {}: {}: {}", lease.jobId, warning.where, warning.feature, warning.instead);
    try {
        with_.farm.reportScene(lease.id, lease.epoch, resident_);
    } catch (const Error& error) {
        spdlog::debug("{}: {}", toString(Endpoint::report), error.what());
        if (actionFor(Endpoint::report, error.code) == Action::stop) with_.standing.mustStop(error.what());
    }
}

// Passes over the same samples go in one call: few dispatches, in the order of the lease.
std::vector<PassFilm> Agent::renderPasses(const Lease& lease, const HeldLease& held) {
    std::vector<PassFilm> films;
    films.reserve(lease.passes.size());
    for (size_t first = 0; first < lease.passes.size() && mayGoOn(held);) {
        const SampleRange samples = lease.passes[first].samples;
        std::vector<uint32_t> tiles;
        for (; first < lease.passes.size() && lease.passes[first].samples == samples; ++first)
            tiles.push_back(lease.passes[first].tile);
        for (PassFilm& film : with_.backend.render(lease.frame, tiles, samples))
            films.push_back(std::move(film));
    }
    return films;
}

// Uploads what there is, also when the lease was lost meanwhile: the server takes what it still needs.
void Agent::finish(const Lease& lease, const std::shared_ptr<HeldLease>& held, std::vector<PassFilm> films,
                   double deviceSeconds) {
    if (held->state == LeaseValidity::jobGone || films.empty()) throw Abandoned();
    FinishedResult result;
    result.leaseId = lease.id;
    result.epoch = lease.epoch;
    result.jobId = lease.jobId;
    result.lease = held;
    result.deviceSeconds = deviceSeconds;
    result.whole = films.size() == lease.passes.size();
    result.films = std::move(films);
    result.image = lease.spec.image;
    result.attributes = attributesOf(lease, hello_);
    with_.results.push(std::move(result));
}

void Agent::handBack(const HeldLease& held) {
    try {
        with_.farm.handBack(held.id, held.epoch);
    } catch (const Error& error) {
        spdlog::debug("{}: {}", toString(Endpoint::handBack), error.what());  // it runs out by itself
    }
}

void Agent::reportFailure(const HeldLease& held, const std::string& message) {
    away_.reset();
    while (held.state == LeaseValidity::valid) {
        try {
            return with_.farm.reportFailure(held.id, held.epoch, message);
        } catch (const Error& error) {
            const Action action = actionFor(Endpoint::failure, error.code);
            if (action == Action::stop) with_.standing.mustStop(error.what());
            const bool again = action == Action::retry || action == Action::hold ||
                               (action == Action::retryFew && away_.failures() < kFewTries);
            if (!again || !mayGoOn(held)) return;
            with_.pause.waitFor(away_.next());
        }
    }
}

void Agent::letGo() {
    with_.backend.drop();
    residentKey_.clear();
    residentJob_.clear();
    resident_ = {};
}

bool Agent::mayGoOn(const HeldLease& held) const {
    return held.state == LeaseValidity::valid && !with_.pause.stopping() && !with_.standing.stopped();
}

}  // namespace tilefarm
