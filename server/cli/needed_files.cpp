#include "server/cli/needed_files.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "shared/job/job.h"

namespace tilefarm {

namespace {

using nlohmann::json;

/// A member, or null where there is none.
const json& in(const json& object, const std::string& name) {
    static const json none;
    if (!object.is_object()) return none;
    const auto member = object.find(name);
    return member == object.end() ? none : *member;
}

const json& extensionIn(const json& object, const std::string& name) {
    return in(in(object, "extensions"), name);
}

bool isZero(const json& factor) {
    const auto zero = [](const json& v) { return v.is_number() && v.get<double>() == 0; };
    return factor.is_array() ? std::all_of(factor.begin(), factor.end(), zero) : zero(factor);
}

constexpr const char* kVariants = "KHR_materials_variants";
constexpr uint64_t kNoVariant = UINT64_MAX;

uint64_t variantNamed(const json& gltf, const std::string& name) {
    uint64_t number = 0;
    for (const json& variant : in(extensionIn(gltf, kVariants), "variants")) {
        if (!name.empty() && in(variant, "name") == name) return number;
        ++number;
    }
    return kNoVariant;
}

/// The factors that make the textures beside them unseen when they are 0, as worker/scene/materials.cpp and
/// material_extensions.cpp read them.
struct Fading {
    std::string_view textures;  // how their names begin
    const char* factor;
    bool zeroIfAbsent;
};
constexpr Fading kFading[] = {
    {"emissive", "emissiveFactor", true},
    {"specularTexture", "specularFactor", false},
    {"specularColorTexture", "specularFactor", false},
    {"clearcoat", "clearcoatFactor", true},
    {"sheen", "sheenColorFactor", true},
    {"anisotropy", "anisotropyStrength", true},
    {"iridescence", "iridescenceFactor", true},
    {"transmission", "transmissionFactor", true},
    {"diffuseTransmission", "diffuseTransmissionFactor", true},
};

/// Whether no picture shows this texture of a material, of its metallic-roughness or of an extension.
bool isUnseen(const json& object, std::string_view name) {
    if (name == "occlusionTexture" || name == "thicknessTexture") return true;
    return std::any_of(std::begin(kFading), std::end(kFading), [&](const Fading& by) {
        const json& factor = in(object, by.factor);
        return name.starts_with(by.textures) && (factor.is_null() ? by.zeroIfAbsent : isZero(factor));
    });
}

class Needs {
public:
    Needs(const json& gltf, const JobSpec& job) : gltf_(gltf), variant_(variantNamed(gltf, job.variant)) {}

    std::set<std::string> of(const std::string& animation) {
        addScene();
        if (showsNothing_) addAll();
        size_t number = 0;
        for (const json& given : in(gltf_, "animations")) {
            const json& name = in(given, "name");
            const std::string known =
                name.is_string() ? name.get<std::string>() : "animations/" + std::to_string(number);
            ++number;
            if (animation == "all" || animation == known) addAnimation(given);
        }
        return std::move(places_);
    }

private:
    /// Calls `add` with the element that an index names, once for each.
    template <typename Add>
    void follow(const char* list, const json& index, Add add) {
        const json& elements = in(gltf_, list);
        if (!index.is_number_unsigned() || !elements.is_array()) return;
        const auto i = index.get<uint64_t>();
        const std::string place = std::string("/") + list + "/" + std::to_string(i);
        if (i < elements.size() && seen_.insert(place).second) add(elements[i], place);
    }

    /// The nodes of the default scene, else of the first, else all.
    void addScene() {
        const json &scenes = in(gltf_, "scenes"), &chosen = in(gltf_, "scene");
        if (!scenes.is_array() || scenes.empty()) {
            for (const json& node : in(gltf_, "nodes")) addNode(node);
            return;
        }
        std::vector<json> open;
        follow("scenes", chosen.is_null() ? json(0u) : chosen, [&](const json& scene, const std::string&) {
            for (const json& root : in(scene, "nodes")) open.push_back(root);
        });
        while (!open.empty()) {
            const json index = std::move(open.back());
            open.pop_back();
            follow("nodes", index, [&](const json& node, const std::string&) {
                addNode(node);
                for (const json& child : in(node, "children")) open.push_back(child);
            });
        }
    }

    /// Of a file that shows nothing all is what it is for, as in worker/scene/gltf_source.cpp.
    void addAll() {
        for (const char* list : {"buffers", "images"})
            for (size_t i = 0; i < in(gltf_, list).size(); ++i)
                places_.insert(std::string("/") + list + "/" + std::to_string(i) + "/uri");
    }

    void addNode(const json& node) {
        showsNothing_ = false;
        follow("meshes", in(node, "mesh"), [&](const json& mesh, const std::string&) {
            for (const json& primitive : in(mesh, "primitives")) addPrimitive(primitive);
        });
        follow("skins", in(node, "skin"),
               [&](const json& skin, const std::string&) { addAccessor(in(skin, "inverseBindMatrices")); });
        for (const json& accessor : in(extensionIn(node, "EXT_mesh_gpu_instancing"), "attributes"))
            addAccessor(accessor);
        addMaterial(in(extensionIn(node, "TILEFARM_shapes"), "material"));
    }

    void addPrimitive(const json& primitive) {
        for (const json& accessor : in(primitive, "attributes")) addAccessor(accessor);
        addAccessor(in(primitive, "indices"));
        for (const json& target : in(primitive, "targets"))
            if (target.is_object())
                for (const json& accessor : target) addAccessor(accessor);
        addView(in(extensionIn(primitive, "KHR_draco_mesh_compression"), "bufferView"));
        addMaterial(materialOf(primitive));
    }

    /// Under the variant that the job wears.
    const json& materialOf(const json& primitive) {
        for (const json& mapping : in(extensionIn(primitive, kVariants), "mappings"))
            for (const json& variant : in(mapping, "variants"))
                if (variant.is_number_unsigned() && variant.get<uint64_t>() == variant_)
                    return in(mapping, "material");
        return in(primitive, "material");
    }

    void addMaterial(const json& index) {
        follow("materials", index, [&](const json& material, const std::string&) {
            addTextures(material);
            if (extensionIn(material, "KHR_materials_pbrSpecularGlossiness").is_null())
                addTextures(in(material, "pbrMetallicRoughness"));
            const json& extensions = in(material, "extensions");
            if (!extensions.is_object()) return;
            for (const auto& [name, extension] : extensions.items())
                if (name.starts_with("KHR_materials_")) addTextures(extension);
        });
    }

    /// Of all members that are called "…Texture".
    void addTextures(const json& object) {
        if (!object.is_object()) return;
        for (const auto& [name, info] : object.items())
            if (name.ends_with("Texture") && !isUnseen(object, name))
                follow("textures", in(info, "index"),
                       [&](const json& texture, const std::string&) { addImage(in(texture, "source")); });
    }

    void addImage(const json& index) {
        follow("images", index, [&](const json& image, const std::string& place) {
            addView(in(image, "bufferView"));
            places_.insert(place + "/uri");
        });
    }

    void addAnimation(const json& animation) {
        for (const json& sampler : in(animation, "samplers")) {
            addAccessor(in(sampler, "input"));
            addAccessor(in(sampler, "output"));
        }
    }

    void addAccessor(const json& index) {
        follow("accessors", index, [&](const json& accessor, const std::string&) {
            addView(in(accessor, "bufferView"));
            addView(in(in(in(accessor, "sparse"), "indices"), "bufferView"));
            addView(in(in(in(accessor, "sparse"), "values"), "bufferView"));
        });
    }

    /// Compressed bytes stand in another buffer than those that are their fallback.
    void addView(const json& index) {
        follow("bufferViews", index, [&](const json& view, const std::string&) {
            const json& khronos = in(extensionIn(view, "KHR_meshopt_compression"), "buffer");
            const json& vendor = in(extensionIn(view, "EXT_meshopt_compression"), "buffer");
            const json& buffer = !khronos.is_null()  ? khronos
                                 : !vendor.is_null() ? vendor
                                                     : in(view, "buffer");
            follow("buffers", buffer,
                   [&](const json&, const std::string& place) { places_.insert(place + "/uri"); });
        });
    }

    const json& gltf_;
    const uint64_t variant_;
    bool showsNothing_ = true;
    std::set<std::string> seen_, places_;
};

}  // namespace

std::set<std::string> neededFiles(const json& gltf, const JobSpec& job) {
    return Needs(gltf, job).of(job.motion.animation);
}

}  // namespace tilefarm
