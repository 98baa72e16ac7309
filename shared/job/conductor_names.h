#pragma once

#include <array>
#include <string_view>

namespace tilefarm {

/// Metals whose measured η and k the worker has (worker/scene/conductors.h), by name. Here so that a job
/// with another one is refused when it is submitted.
inline constexpr std::array<std::string_view, 15> kConductorNames{
    "gold",     "silver",    "copper", "aluminium", "aluminum", "iron", "chromium", "nickel",
    "titanium", "palladium", "cobalt", "platinum",  "tungsten", "zinc", "brass"};

}  // namespace tilefarm
