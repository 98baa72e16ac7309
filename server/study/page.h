#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tilefarm {

/// A study as one HTML page that needs nothing from elsewhere: its view as the API gives it, and of the cells
/// at the most samples the pictures by the variant's number, with "reference".
std::string studyPage(const nlohmann::json& view, const nlohmann::json& pictures);

}  // namespace tilefarm
