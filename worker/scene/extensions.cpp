#include "worker/scene/extensions.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

namespace tilefarm {
namespace {

struct KnownExtension {
    std::string_view name;
    std::string_view
        instead;  // empty: rendered, or changes nothing in a picture, or warned of where it stands
    bool mayBeRequired = true;
};

// A lobe that the renderer learns loses its text here and gains a reader in materials.cpp.
constexpr KnownExtension kKnown[] = {
    {"KHR_animation_pointer", ""},
    {"EXT_mesh_gpu_instancing", ""},
    {"EXT_meshopt_compression", ""},
    {"KHR_draco_mesh_compression", ""},
    {"KHR_implicit_shapes", ""},
    {"TILEFARM_shapes", ""},
    // These change no picture: what a scene does when somebody acts on it, or says about itself.
    {"EXT_instance_features", ""},
    {"EXT_mesh_features", ""},
    {"EXT_structural_metadata", ""},
    {"KHR_interactivity", ""},
    {"KHR_node_hoverability", ""},
    {"KHR_node_selectability", ""},
    {"KHR_lights_punctual", ""},
    {"KHR_materials_anisotropy", ""},
    {"KHR_materials_clearcoat", ""},
    {"KHR_materials_diffuse_transmission", ""},
    {"KHR_materials_dispersion", ""},
    {"KHR_materials_emissive_strength", ""},
    {"KHR_materials_ior", ""},
    {"KHR_materials_iridescence", ""},
    {"KHR_materials_pbrSpecularGlossiness", ""},
    {"KHR_materials_sheen", ""},
    {"KHR_materials_specular", ""},
    {"KHR_materials_transmission", ""},
    {"KHR_materials_unlit", ""},
    {"KHR_materials_variants", ""},
    {"KHR_materials_volume", ""},
    {"KHR_mesh_quantization", ""},
    {"KHR_meshopt_compression", ""},
    {"KHR_node_visibility", ""},
    {"KHR_texture_transform", ""},
    {"KHR_xmp", ""},
    {"KHR_xmp_json_ld", ""},
    {"TILEFARM_lights", ""},
    {"TILEFARM_materials", ""},
    {"EXT_texture_avif", "", false},  // textures.cpp warns of these
    {"EXT_texture_webp", "", false},
    {"KHR_texture_basisu", "", false},
    {"MSFT_texture_dds", "", false},
    {"KHR_materials_volume_scatter", "rendered with absorption alone"},
};

const KnownExtension* find(std::string_view name) {
    const auto* known =
        std::find_if(std::begin(kKnown), std::end(kKnown),
                     [name](const KnownExtension& extension) { return extension.name == name; });
    return known == std::end(kKnown) ? nullptr : known;
}

/// Extensions that stand somewhere in the file though it does not declare them, once each.
void warnOfUndeclared(LoadContext& load, std::set<std::string> warned) {
    std::vector<JsonNode> open{load.file.root()};
    while (!open.empty()) {
        const JsonNode node = open.back();
        open.pop_back();
        for (const auto& [key, value] : node.json().items()) {
            if (!value.is_structured()) {
                continue;
            }
            open.push_back(node.isObject() ? node[key] : node[std::stoul(key)]);
            if (key != "extensions" || !node.isObject() || !value.is_object()) {
                continue;
            }
            for (const auto& [name, extension] : value.items()) {
                if (!find(name) && warned.insert(name).second) {
                    load.warn(name, node, "not known, left out");
                }
            }
        }
    }
}

}  // namespace

void checkExtensions(LoadContext& load) {
    const JsonNode required = load.file.root()["extensionsRequired"];
    for (size_t i = 0; i < required.size(); ++i) {
        if (const KnownExtension* known = find(required[i].text()); !known || !known->mayBeRequired) {
            required[i].fail(
                fmt::format("the scene cannot be read without {}, which is not known", required[i].text()));
        }
    }
    const JsonNode used = load.file.root()["extensionsUsed"];
    std::set<std::string> warned;
    for (size_t i = 0; i < used.size(); ++i) {
        if (!find(used[i].text()) && warned.insert(used[i].text()).second) {
            load.warn(used[i].text(), used[i], "not known, left out");
        }
    }
    warnOfUndeclared(load, std::move(warned));
    warnOfNotRendered(load, load.file.root());
}

void warnOfNotRendered(LoadContext& load, const JsonNode& object) {
    for (const std::string& name : object["extensions"].keys()) {
        const KnownExtension* known = find(name);
        if (known && !known->instead.empty()) {
            load.warn(name, object, std::string(known->instead));
        }
    }
}

}  // namespace tilefarm
