#pragma once

#include <string_view>

namespace tilefarm {

/// The page at `/`: server/web/status_page.html, embedded at build time; asks nothing of other hosts.
std::string_view statusPage();

}  // namespace tilefarm
