#include "shared/matte/scene_names.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "shared/error/error.h"
#include "shared/film/layout.h"
#include "shared/gltf/gltf_bytes.h"
#include "shared/job/job.h"
#include "shared/matte/cryptomatte.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr const char* kLights = "KHR_lights_punctual";

// Only what leads to names is kept: a scene's JSON is mostly accessors and transforms.
bool isWanted(int depth, json::parse_event_t event, json& parsed) {
    if (event != json::parse_event_t::key) return true;
    const auto& key = parsed.get_ref<const std::string&>();
    switch (depth) {
        case 1: return key == "nodes" || key == "materials" || key == "extensions";
        case 2: return key == kLights;
        case 3: return key == "name" || key == "lights";
        default: return depth == 5 && key == "name";
    }
}

// Of an element that may be no object.
const std::string* nameIn(const json& element) {
    if (!element.is_object()) return nullptr;
    const auto name = element.find("name");
    return name == element.end() ? nullptr : name->get_ptr<const std::string*>();
}

const json& listIn(const json& object, const char* key) {
    static const json none = json::array();
    if (!object.is_object()) return none;
    const auto list = object.find(key);
    return list != object.end() && list->is_array() ? *list : none;
}

void addLights(SceneNames& names, const json& gltf, const JobSpec& job) {
    const auto extensions = gltf.find("extensions");
    if (extensions != gltf.end() && extensions->is_object() && extensions->contains(kLights))
        for (const json& light : listIn((*extensions)[kLights], "lights"))
            if (const std::string* name = nameIn(light)) names.objects.insert(*name);
    for (const LightSettings& light : job.lights) names.objects.insert(lightName(light.name));
}

}  // namespace

std::string nodeName(size_t index) {
    return fmt::format("nodes/{}", index);
}
std::string materialName(const std::string& name, size_t index) {
    return name.empty() ? fmt::format("materials/{}", index) : name;
}
std::string lightName(const std::string& name) {
    return name.empty() ? "light" : name;
}

SceneNames sceneNames(const GltfBytes& source, const JobSpec& job) {
    const json gltf = readGltfJson(source, isWanted);
    SceneNames names;
    const json &nodes = listIn(gltf, "nodes"), &materials = listIn(gltf, "materials");
    for (size_t i = 0; i < nodes.size(); ++i) {
        const std::string* name = nameIn(nodes[i]);
        names.objects.insert(name ? *name : nodeName(i));
    }
    for (size_t i = 0; i < materials.size(); ++i) {
        const std::string* name = nameIn(materials[i]);
        names.materials.insert(materialName(name ? *name : "", i));
    }
    names.materials.insert({kDefaultMaterialName, kLightMaterialName});
    addLights(names, gltf, job);
    return names;
}

MatteMetadata matteMetadata(const GltfBytes& gltf, const JobSpec& job) {
    if (!job.output.cryptomatte) return {};
    SceneNames names;
    try {
        names = sceneNames(gltf, job);
    } catch (const Error&) {
        // The picture is worth more than its manifest.
    }
    const MatteManifest place = job.output.cryptomatteManifest;
    MatteMetadata metadata = matteMetadata(kMattes[0], names.objects, place);
    metadata.add(matteMetadata(kMattes[1], names.materials, place));
    return metadata;
}

}  // namespace tilefarm
