#pragma once

#include <string_view>

namespace tilefarm {

/// server/api/openapi.json, embedded at build time.
std::string_view openApiJson();

}  // namespace tilefarm
