#include "shared/gltf/picture_size.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "shared/error/error.h"
#include "shared/job/job.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr uint32_t kUsualWidth = 640, kUsualHeight = 360, kLargest = 32768;

/// What lies there, or null: the file has not been checked.
const json& at(const json& value, const char* member) {
    static const json none;
    if (!value.is_object()) return none;
    const auto found = value.find(member);
    return found == value.end() ? none : *found;
}
const json& at(const json& list, size_t index) {
    static const json none;
    return list.is_array() && index < list.size() ? list[index] : none;
}
size_t indexIn(const json& value) {
    return value.is_number_unsigned() ? value.get<size_t>() : SIZE_MAX;
}
std::string textIn(const json& value) {
    return value.is_string() ? value.get<std::string>() : std::string();
}

// All that leads to cameras; a scene's JSON is mostly accessors.
bool leadsToCameras(int depth, json::parse_event_t event, json& parsed) {
    if (event != json::parse_event_t::key || depth != 1) return true;
    const auto& key = parsed.get_ref<const std::string&>();
    return key == "cameras" || key == "nodes" || key == "scenes" || key == "scene";
}

struct PlacedCamera {
    size_t camera;
    std::string name, node;
};

std::vector<size_t> rootsOf(const json& gltf) {
    std::vector<size_t> roots;
    const json &scenes = at(gltf, "scenes"), &chosen = at(gltf, "scene");
    if (scenes.empty() && chosen.is_null()) {
        const size_t count = at(gltf, "nodes").size();
        std::vector<bool> isChild(count);
        for (size_t i = 0; i < count; ++i)
            for (const json& child : at(at(at(gltf, "nodes"), i), "children"))
                if (indexIn(child) < count) isChild[indexIn(child)] = true;
        for (size_t i = 0; i < count; ++i)
            if (!isChild[i]) roots.push_back(i);
        return roots;
    }
    for (const json& root : at(at(scenes, chosen.is_null() ? 0 : indexIn(chosen)), "nodes"))
        roots.push_back(indexIn(root));
    return roots;
}

bool isVisible(const json& node) {
    const json& visible = at(at(at(node, "extensions"), "KHR_node_visibility"), "visible");
    return !visible.is_boolean() || visible.get<bool>();
}

/// In the order in which the loader meets them (worker/scene/nodes.cpp).
std::vector<PlacedCamera> placedCameras(const json& gltf) {
    const json &nodes = at(gltf, "nodes"), &cameras = at(gltf, "cameras");
    std::vector<PlacedCamera> placed;
    std::vector<bool> visited(nodes.size());
    std::vector<size_t> open = rootsOf(gltf);
    std::reverse(open.begin(), open.end());
    while (!open.empty()) {
        const size_t index = open.back();
        open.pop_back();
        if (index >= visited.size() || visited[index]) continue;
        visited[index] = true;
        const json& node = at(nodes, index);
        if (!isVisible(node)) continue;
        if (const size_t camera = indexIn(at(node, "camera")); camera < cameras.size()) {
            std::string name = textIn(at(at(cameras, camera), "name"));
            const json& ofNode = at(node, "name");
            const std::string nodeName = ofNode.is_string() ? textIn(ofNode) : fmt::format("nodes/{}", index);
            placed.push_back({camera, name.empty() ? nodeName : name, nodeName});
        }
        const json& children = at(node, "children");
        for (size_t i = children.size(); i-- > 0;) open.push_back(indexIn(at(children, i)));
    }
    return placed;
}

/// As selectCamera (worker/scene/load.h) chooses.
const PlacedCamera* selected(const std::vector<PlacedCamera>& cameras, const std::string& name) {
    for (const PlacedCamera& camera : cameras)
        if (name == "auto" || camera.name == name) return &camera;
    for (const PlacedCamera& camera : cameras)
        if (camera.node == name) return &camera;
    return nullptr;
}

std::optional<double> aspectOf(const json& camera) {
    const auto number = [](const json& value) { return value.is_number() ? value.get<double>() : 0; };
    const json& flat = at(camera, "orthographic");
    const double aspect = textIn(at(camera, "type")) == "orthographic"
                              ? std::abs(number(at(flat, "xmag")) / number(at(flat, "ymag")))
                              : number(at(at(camera, "perspective"), "aspectRatio"));
    if (!(aspect > 0) || !std::isfinite(aspect)) return std::nullopt;
    return aspect;
}

uint32_t pixels(double value) {
    return static_cast<uint32_t>(std::lround(std::clamp(value, 1.0, double{kLargest})));
}

}  // namespace

std::optional<double> cameraAspect(const GltfBytes& gltf, const JobSpec& job) {
    if (job.view.kind == ViewKind::panorama) return 2;
    if (job.view.kind != ViewKind::scene) return std::nullopt;
    try {
        const json document = readGltfJson(gltf, leadsToCameras);
        const std::vector<PlacedCamera> cameras = placedCameras(document);
        const PlacedCamera* camera = selected(cameras, job.camera);
        return camera ? aspectOf(at(at(document, "cameras"), camera->camera)) : std::nullopt;
    } catch (const Error&) {
        return std::nullopt;  // the loader says what is wrong with it
    }
}

ImageSpec pictureSize(const GltfBytes& gltf, const JobSpec& job) {
    ImageSpec image = job.image;
    if (image.width > 0 && image.height > 0) return image;
    const std::optional<double> aspect = cameraAspect(gltf, job);
    if (!aspect) {
        if (image.width == 0) image.width = kUsualWidth;
        if (image.height == 0) image.height = kUsualHeight;
        return image;
    }
    if (image.width == 0 && image.height == 0) (*aspect >= 1 ? image.width : image.height) = kUsualWidth;
    if (image.width == 0)
        image.width = pixels(image.height * *aspect);
    else
        image.height = pixels(image.width / *aspect);
    return image;
}

}  // namespace tilefarm
