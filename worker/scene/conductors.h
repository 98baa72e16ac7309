#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace tilefarm {

/// Complex index of refraction η + i k of a metal against vacuum, at about 630, 532 and 465 nm (R, G, B).
struct Conductor {
    glm::vec3 eta, k;
};

/// The measured metal of that name ("gold", "aluminium", "aluminum", "ni" …), upper or lower case.
std::optional<Conductor> conductorNamed(std::string_view name);

/// The names that conductorNamed knows, without their synonyms.
std::vector<std::string_view> conductorNames();

}  // namespace tilefarm
