#include "worker/scene/material_override.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene_material_override.h"
#include "shared/error/error.h"
#include "shared/job/appearance.h"
#include "worker/scene/conductors.h"

namespace tilefarm {
namespace {

template <typename To, typename From>
void set(To& to, const std::optional<From>& given) {
    if (given) to = *given;
}

void set(glm::vec3& to, const std::optional<Color>& given) {
    if (given) to = {(*given)[0], (*given)[1], (*given)[2]};
}

void setClearcoat(Material& m, const MaterialOverride& o) {
    if (o.clearcoatRoughness) m.clearcoatGtr1 = false;
    if (o.clearcoatGloss) {
        // Burley 2012, 5.5: α from 0.1 to 0.001.
        m.clearcoatRoughness = std::sqrt(std::lerp(0.1f, 0.001f, *o.clearcoatGloss));
        m.clearcoatGtr1 = true;
    }
}

void setConductor(Material& m, const std::string& name) {
    const std::optional<Conductor> metal = conductorNamed(name);
    if (!metal) {
        throw Error(ErrorCode::invalidArgument, fmt::format("there is no conductor named '{}'; there are {}",
                                                            name, fmt::join(conductorNames(), ", ")));
    }
    m.conductor = true;
    m.conductorEta = metal->eta;
    m.conductorK = metal->k;
}

std::string namesOf(const std::vector<Material>& materials) {
    constexpr size_t most = 12;
    std::string names;
    for (size_t i = 0; i < std::min(materials.size(), most); ++i)
        names += (names.empty() ? "" : ", ") + ("'" + materials[i].name + "'");
    return materials.size() > most ? names + " …" : names;
}

// An animated scene is made anew for each of its times.
void warnOnce(Scene& scene, const std::string& where, const std::string& instead) {
    const auto same = [&](const SceneWarning& w) { return w.where == where; };
    if (std::none_of(scene.warnings.begin(), scene.warnings.end(), same))
        scene.warnings.push_back({"material override", where, instead});
}

}  // namespace

void applyOverride(Material& m, const MaterialOverride& o) {
    setParameters(m, o, [](auto& to, const auto& given) { set(to, given); });
    setClearcoat(m, o);
    if (o.conductor) setConductor(m, *o.conductor);
}

bool matchesName(std::string_view pattern, std::string_view name) {
    size_t p = 0, n = 0, star = std::string_view::npos, after = 0;
    while (n < name.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            after = n;
        } else if (p < pattern.size() && pattern[p] == name[n]) {
            ++p;
            ++n;
        } else if (star != std::string_view::npos) {  // the last star takes one more
            p = star + 1;
            n = ++after;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*') ++p;
    return p == pattern.size();
}

void applyOverrides(Scene& scene, const std::vector<MaterialOverride>& overrides) {
    for (size_t i = 0; i < overrides.size(); ++i) {
        bool found = false;
        for (Material& material : scene.materials) {
            if (!matchesName(overrides[i].material, material.name)) continue;
            applyOverride(material, overrides[i]);
            found = true;
        }
        if (!found) {
            warnOnce(scene, fmt::format("the job's /materials/{}", i),
                     fmt::format("no material is named '{}'; there are {}", overrides[i].material,
                                 namesOf(scene.materials)));
        }
    }
}

}  // namespace tilefarm
