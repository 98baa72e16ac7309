#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tilefarm {

/// Sentences for people, from a whole result: which setting is worth its time at the most samples, what it
/// costs in bias, and which are not. A setting is worth its time where the 95 % interval of its efficiency's
/// ratio to the base's lies above 1.
std::string studyVerdict(const nlohmann::json& result);

}  // namespace tilefarm
