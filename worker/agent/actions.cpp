#include "worker/agent/actions.h"

#include <algorithm>
#include <array>
#include <optional>

namespace tilefarm {
namespace {

using enum ErrorCode;

struct Rule {
    std::optional<Endpoint> endpoint;  // none: every one that has no rule of its own
    ErrorCode code;
    Action action;
};

constexpr std::array kRules{
    // Alike everywhere.
    Rule{{}, unauthorized, Action::stop},          // 401: wrong or no token
    Rule{{}, forbidden, Action::stop},             // 403
    Rule{{}, versionRefused, Action::stop},        // 426: says which version is wanted
    Rule{{}, tooMany, Action::retry},              // 429
    Rule{{}, unavailable, Action::retry},          // 503, or no answer at all
    Rule{{}, internal, Action::retry},             // 500
    Rule{{}, outOfSpace, Action::hold},            // 507; for a blob also the disk here
    Rule{{}, gone, Action::dropJob},               // 410: canceled or deleted
    Rule{{}, conflict, Action::dropLease},         // 409: lost to another
    Rule{{}, notFound, Action::dropLease},         // 404: the server forgot the lease
    Rule{{}, invalidArgument, Action::dropLease},  // 400
    Rule{{}, tooLarge, Action::dropLease},         // 413
    Rule{{}, unprocessable, Action::dropLease},    // 422
    // Asking for work holds no lease yet.
    Rule{Endpoint::lease, notFound, Action::stop},         // no Tilefarm server at this address
    Rule{Endpoint::lease, invalidArgument, Action::stop},  // it does not understand this worker
    Rule{Endpoint::lease, tooLarge, Action::stop},
    Rule{Endpoint::lease, unprocessable, Action::stop},
    Rule{Endpoint::lease, conflict, Action::retry},
    Rule{Endpoint::lease, gone, Action::retry},
    // A file that is not to be had is a fault of the scene.
    Rule{Endpoint::blob, notFound, Action::refused},
    Rule{Endpoint::blob, invalidArgument, Action::refused},
    Rule{Endpoint::blob, tooLarge, Action::refused},
    Rule{Endpoint::blob, unprocessable, Action::refused},  // arrived damaged, twice
    Rule{Endpoint::blob, internal, Action::retryFew},
    // Bytes that the server refuses stay refused.
    Rule{Endpoint::result, invalidArgument, Action::refused},
    Rule{Endpoint::result, tooLarge, Action::refused},
    Rule{Endpoint::result, unprocessable, Action::refused},
    Rule{Endpoint::result, internal, Action::retryFew},
    // Courtesies: not worth holding a worker up for.
    Rule{Endpoint::handBack, internal, Action::dropLease},
    Rule{Endpoint::failure, internal, Action::retryFew},
    Rule{Endpoint::report, internal, Action::dropLease},
};

}  // namespace

Action actionFor(Endpoint endpoint, ErrorCode code) {
    const Rule* general = nullptr;
    for (const Rule& rule : kRules) {
        if (rule.code != code) continue;
        if (rule.endpoint == endpoint) return rule.action;
        if (!rule.endpoint) general = &rule;
    }
    return general ? general->action : Action::stop;
}

std::string_view toString(Endpoint endpoint) {
    switch (endpoint) {
        case Endpoint::lease: return "asking for work";
        case Endpoint::blob: return "fetching a file of the scene";
        case Endpoint::renew: return "renewing a lease";
        case Endpoint::result: return "uploading a result";
        case Endpoint::handBack: return "handing a lease back";
        case Endpoint::failure: return "reporting a failure";
        case Endpoint::report: return "reporting on a scene";
    }
    return "";
}

std::string_view toString(Action action) {
    switch (action) {
        case Action::dropLease: return "drop the lease";
        case Action::dropJob: return "drop the job";
        case Action::refused: return "refused";
        case Action::retry: return "retry";
        case Action::retryFew: return "retry a few times";
        case Action::hold: return "ask for no work for a while";
        case Action::stop: return "stop";
    }
    return "";
}

}  // namespace tilefarm
