#include "worker/scene/load_context.h"

#include <algorithm>

namespace tilefarm {

void LoadContext::warn(const std::string& feature, const JsonNode& where, const std::string& instead) {
    const std::string label = labelOf(where);
    const auto same = [&](const SceneWarning& w) { return w.feature == feature && w.where == label; };
    if (std::none_of(scene.warnings.begin(), scene.warnings.end(), same)) {
        scene.warnings.push_back({feature, label, instead});
    }
}

std::string labelOf(const JsonNode& node) {
    std::string label = node.place().empty() ? "" : node.place().substr(1);
    if (node && node.isObject()) {
        if (const JsonNode name = node["name"]; name.isString()) {
            label += " (" + name.text() + ")";
        }
    }
    return label;
}

}  // namespace tilefarm
