#pragma once

#include <string_view>

namespace tilefarm {

/// The page of a study with places for its data and for the script that draws charts.
std::string_view studyTemplate();
/// Chart.js (MIT License), as Debian packages it.
std::string_view chartScript();

}  // namespace tilefarm
