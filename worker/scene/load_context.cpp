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

void LoadContext::requireMaterial(uint32_t material) const {
    if (const auto broken = brokenMaterials.find(material); broken != brokenMaterials.end()) {
        throw broken->second;
    }
}

}  // namespace tilefarm
