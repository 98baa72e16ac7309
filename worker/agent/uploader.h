#pragma once

#include <filesystem>
#include <string>

#include "worker/agent/actions.h"
#include "worker/agent/backoff.h"
#include "worker/agent/lease_keeper.h"
#include "worker/agent/pause.h"
#include "worker/agent/result_queue.h"
#include "worker/agent/result_store.h"

namespace tilefarm {

/// Brings finished results to the server, one after the other. A result is kept, on disk once the first
/// try has failed, until the server has said that it has it or that it does not want it.
class Uploader {
public:
    struct Parts {
        Farm& farm;
        ResultQueue& queue;
        ResultStore& store;
        LeaseKeeper& keeper;
        Standing& standing;
        Pause& pause;
        const Clock& clock;
    };
    Uploader(Parts parts, uint32_t seed);

    /// Until the queue is closed and empty.
    void run();
    /// Returns when the server has settled the matter, or, while the worker is stopping, after one try:
    /// the result is on disk then.
    void settle(FinishedResult result);

private:
    enum class Outcome { settled, again, later };

    StoredResult encoded(FinishedResult& result) const;
    Outcome tryOnce(const StoredResult& upload, const FinishedResult& result);
    Outcome afterError(const Error& error, const StoredResult& upload, const FinishedResult& result);
    void keep(const StoredResult& upload, std::filesystem::path& file);
    void courtesy(Endpoint endpoint, const StoredResult& upload, const std::string& message);

    Parts with_;
    Backoff backoff_;
};

}  // namespace tilefarm
