#include "worker/agent/uploader.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <utility>

#include "shared/digest/digest.h"

namespace tilefarm {
namespace {

constexpr Milliseconds kFirstWait{250}, kLongestWait{5'000};
// How long to ask for no work when the server's disk is low, and how often to offer a result again.
constexpr Milliseconds kHoldLeasing{60'000}, kOfferAgain{10'000};
constexpr uint32_t kFewTries = 8;

}  // namespace

Uploader::Uploader(Parts parts, uint32_t seed) : with_(parts), backoff_(kFirstWait, kLongestWait, seed) {}

void Uploader::run() {
    while (auto result = with_.queue.take()) settle(std::move(*result));
}

void Uploader::settle(FinishedResult result) {
    StoredResult upload;
    try {
        upload = encoded(result);
    } catch (const std::exception& error) {
        spdlog::error("dropped a result of lease {}: {}", result.leaseId, error.what());
        with_.store.remove(result.file);
        if (result.lease) with_.keeper.release(*result.lease);
        return;
    }
    backoff_.reset();
    while (true) {
        const Outcome outcome = tryOnce(upload, result);
        if (outcome == Outcome::settled) break;
        keep(upload, result.file);
        if (with_.pause.stopping()) return;  // it is on disk for the next run
        with_.pause.waitFor(outcome == Outcome::later ? backoff_.jittered(kOfferAgain) : backoff_.next());
    }
    if (result.lease) with_.keeper.release(*result.lease);
    if (!result.file.empty()) with_.store.remove(result.file);
}

// The films go as soon as they are encoded: they take as much memory as the file.
StoredResult Uploader::encoded(FinishedResult& result) const {
    if (result.films.empty()) return with_.store.load(result.file);
    StoredResult upload{
        result.leaseId, result.epoch, result.jobId, result.deviceSeconds, result.whole, {}, {}};
    upload.exr = encodePassFilms(result.films, result.image, result.attributes);
    result.films = {};
    upload.sha256 = sha256Hex(upload.exr);
    return upload;
}

Uploader::Outcome Uploader::tryOnce(const StoredResult& upload, const FinishedResult& result) {
    if (with_.standing.isGone(upload.jobId)) return Outcome::settled;
    if (with_.standing.stopped()) return Outcome::again;
    try {
        const ResultReceipt receipt = with_.farm.upload(
            {upload.leaseId, upload.epoch, upload.exr, upload.sha256, upload.deviceSeconds});
        spdlog::debug("lease {}: {} passes merged, {} were there", upload.leaseId, receipt.merged,
                      receipt.alreadyMerged);
        if (!upload.whole) courtesy(Endpoint::handBack, upload, {});
        return Outcome::settled;
    } catch (const Error& error) {
        return afterError(error, upload, result);
    }
}

Uploader::Outcome Uploader::afterError(const Error& error, const StoredResult& upload,
                                       const FinishedResult& result) {
    const Action action = actionFor(Endpoint::result, error.code);
    if (result.file.empty() || action != Action::retry)
        spdlog::warn("result of lease {}: {} ({})", upload.leaseId, error.what(), toString(action));
    switch (action) {
        case Action::dropLease: return Outcome::settled;
        case Action::dropJob: with_.standing.jobGone(upload.jobId); return Outcome::settled;
        case Action::refused:
            courtesy(Endpoint::failure, upload,
                     fmt::format("the server refused the result: {}", error.what()));
            return Outcome::settled;
        case Action::retry: return Outcome::again;
        case Action::retryFew:
            if (backoff_.failures() < kFewTries) return Outcome::again;
            courtesy(Endpoint::handBack, upload, {});
            return Outcome::settled;
        case Action::hold:
            with_.standing.holdLeasing(with_.clock.now() + kHoldLeasing);
            return Outcome::later;
        case Action::stop: with_.standing.mustStop(error.what()); return Outcome::again;
    }
    return Outcome::settled;
}

void Uploader::keep(const StoredResult& upload, std::filesystem::path& file) {
    if (!file.empty()) return;
    try {
        file = with_.store.save(upload);
    } catch (const Error& error) {
        spdlog::warn("a result is kept in memory only: {}", error.what());
    }
}

// Tells the server what it would find out by itself when the lease runs out.
void Uploader::courtesy(Endpoint endpoint, const StoredResult& upload, const std::string& message) {
    try {
        if (endpoint == Endpoint::handBack)
            with_.farm.handBack(upload.leaseId, upload.epoch);
        else
            with_.farm.reportFailure(upload.leaseId, upload.epoch, message);
    } catch (const Error& error) {
        spdlog::debug("{}: {}", toString(endpoint), error.what());
    }
}

}  // namespace tilefarm
