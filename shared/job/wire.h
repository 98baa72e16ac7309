#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "shared/error/error.h"
#include "shared/job/job.h"
#include "shared/job/lease.h"

namespace tilefarm {

/// Parses a text as JSON. Throws Error(invalidArgument) with line and column of the fault; also for
/// duplicate keys and for nesting deeper than 64.
nlohmann::json parseJson(std::string_view text);

/// Job JSON -> JobSpec, or Error(invalidArgument) whose `faults` lists every fault with its JSON
/// pointer: wrong types, unknown members, values out of range, unsafe paths, missing files.
/// Members that may be left out take the defaults of JobSpec.
JobSpec jobFromJson(const nlohmann::json& json);
nlohmann::json toJson(const JobSpec& spec);

Lease leaseFromJson(const nlohmann::json& json);
nlohmann::json toJson(const Lease& lease);
WorkerHello helloFromJson(const nlohmann::json& json);
nlohmann::json toJson(const WorkerHello& hello);
ResultReceipt receiptFromJson(const nlohmann::json& json);
nlohmann::json toJson(const ResultReceipt& receipt);

}  // namespace tilefarm
