#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "shared/error/error.h"
#include "shared/job/job.h"
#include "shared/job/lease.h"

namespace tilefarm {

struct JsonRules {
    bool repeatedNames = false;  // of members of one object: the last counts
    size_t deepest = 64;         // levels of nesting
};

/// Parses a text as JSON. Throws Error(invalidArgument) with line and column of the fault; also of what the
/// rules forbid.
nlohmann::json parseJson(std::string_view text, const JsonRules& rules = {});

/// Job JSON -> JobSpec, or Error(invalidArgument) whose `faults` lists every fault with its JSON
/// pointer: wrong types, unknown members, values out of range, unsafe paths, missing files.
/// Members that may be left out take the defaults of JobSpec. Frames that a list names have the first and the
/// count that follow from it.
JobSpec jobFromJson(const nlohmann::json& json);
/// The member `stop` of a job by itself.
StopCondition stopFromJson(const nlohmann::json& json);
/// Canonical: every member, also those at their default; but for what has none, like a size that is open.
nlohmann::json toJson(const JobSpec& spec);
/// JSON Schema (2020-12) of what jobFromJson accepts, for openapi.json and the README.
nlohmann::json jobSchema();
/// A member name as a part of an RFC 6901 pointer: '~' and '/' escaped.
std::string pointerToken(std::string_view member);

/// Like jobFromJson; also checks that every pass lies in the image.
Lease leaseFromJson(const nlohmann::json& json);
nlohmann::json toJson(const Lease& lease);
/// Unknown members are passed over: a worker of another version must get as far as being told so.
WorkerHello helloFromJson(const nlohmann::json& json);
nlohmann::json toJson(const WorkerHello& hello);
ResultReceipt receiptFromJson(const nlohmann::json& json);
nlohmann::json toJson(const ResultReceipt& receipt);

}  // namespace tilefarm
