#pragma once

#include <map>
#include <nlohmann/json.hpp>

#include "server/study/plan.h"

namespace tilefarm {

/// What a study shows, from what was measured of its cells so far: {"verdict", "variants", "knobs"}. Each
/// cell has beside its own figures how it stands to the base at the same samples and, by the law that
/// variance falls as 1/n, at the base's device seconds; and whether it is on the Pareto front.
nlohmann::json studyResult(const StudyPlan& plan, const std::map<uint32_t, nlohmann::json>& measured);

/// One line per cell, for spreadsheets (RFC 4180).
std::string studyCsv(const nlohmann::json& result);

}  // namespace tilefarm
