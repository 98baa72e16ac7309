#pragma once

#include <string>

namespace tilefarm {

/// What the scene holds and the renderer treats otherwise.
struct SceneWarning {
    std::string feature;  // "KHR_materials_sheen"
    std::string where;    // "materials/3 (Cloth)"
    std::string instead;  // "rendered without sheen"
};

}  // namespace tilefarm
