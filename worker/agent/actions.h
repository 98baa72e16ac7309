#pragma once

#include <string_view>

#include "shared/error/error.h"

namespace tilefarm {

/// What a worker calls on the server.
enum class Endpoint { lease, blob, renew, result, handBack, failure, report };

/// What a worker does when such a call fails.
enum class Action {
    dropLease,  // the server counts without this lease: let go of it and go on
    dropJob,    // the job is gone: let go of the lease and of all that is kept for the job
    refused,    // the server will never take this: say so and do not send the same again
    retry,      // later, with growing waits; finished results are kept on disk meanwhile
    retryFew,   // as retry, but a few times only: a fault of the server may lie in just this request
    hold,       // the disk is low: keep results, ask for no work for a while, then retry
    stop,       // nothing will work until a person changes something
};

/// The one table of what every (endpoint, fault) means to a worker. An unreachable server is
/// ErrorCode::unavailable. Total: there is an answer for every pair.
Action actionFor(Endpoint endpoint, ErrorCode code);

std::string_view toString(Endpoint endpoint);
std::string_view toString(Action action);

}  // namespace tilefarm
