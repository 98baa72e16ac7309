#pragma once

#include <nlohmann/json_fwd.hpp>

#include "server/store/job_store.h"

namespace tilefarm {

/// What a job cost and what the workers had to say: seconds per worker and per device, warnings and
/// features they reported. The error curves stand beside it in the API's answer.
nlohmann::json jobReport(const ConstTables& t, const JobRow& job);

}  // namespace tilefarm
