#include "worker/scene/variants.h"

#include <fmt/format.h>

namespace tilefarm {
namespace {

constexpr const char* kName = "KHR_materials_variants";

JsonNode variantsOf(const JsonNode& root) {
    return root["extensions"][kName]["variants"];
}

}  // namespace

uint32_t findVariant(const JsonNode& root, const std::string& name) {
    if (name.empty()) {
        return kNone;
    }
    const JsonNode variants = variantsOf(root);
    std::string known;
    for (size_t i = 0; i < variants.size(); ++i) {
        const std::string& candidate = variants[i]["name"].text();
        if (candidate == name) {
            return static_cast<uint32_t>(i);
        }
        known += (known.empty() ? "" : ", ") + candidate;
    }
    root.fail(known.empty() ? fmt::format("has no material variants, and so none named '{}'", name)
                            : fmt::format("has no material variant '{}'; there are {}", name, known));
}

void checkMappings(const JsonNode& root, const JsonNode& primitive) {
    const JsonNode mappings = primitive["extensions"][kName]["mappings"];
    const size_t variants = variantsOf(root).size(), materials = root["materials"].size();
    for (size_t i = 0; i < mappings.size(); ++i) {
        mappings[i]["material"].index(materials, "/materials");
        const JsonNode of = mappings[i]["variants"];
        for (size_t k = 0; k < of.size(); ++k) {
            of[k].index(variants, "/extensions/KHR_materials_variants/variants");
        }
    }
}

uint32_t materialOf(const LoadContext& load, const JsonNode& primitive) {
    const size_t materials = load.file.root()["materials"].size();
    const JsonNode mappings = primitive["extensions"][kName]["mappings"];
    for (size_t i = 0; i < mappings.size() && load.variant != kNone; ++i) {
        const JsonNode of = mappings[i]["variants"];
        for (size_t k = 0; k < of.size(); ++k) {
            if (of[k].integer(kNone - 1) == load.variant) {
                return mappings[i]["material"].index(materials, "/materials");
            }
        }
    }
    const JsonNode material = primitive["material"];
    return material ? material.index(materials, "/materials") : kNone;
}

}  // namespace tilefarm
