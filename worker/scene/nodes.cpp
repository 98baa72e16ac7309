#include "worker/scene/nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "worker/scene/cameras_lights.h"
#include "worker/scene/limits.h"
#include "worker/scene/mesh_repair.h"
#include "worker/scene/shape_reader.h"
#include "worker/scene/transform.h"
#include "worker/scene/vectors.h"

namespace tilefarm {
namespace {

/// The forest of nodes. Iterative throughout: a chain may be as long as the file.
class NodeTree {
public:
    explicit NodeTree(const JsonNode& root)
        : nodes_(root["nodes"]), children_(nodes_.size()), toWorld_(nodes_.size()) {
        findParents();
        compose();
    }

    size_t size() const { return children_.size(); }
    JsonNode node(uint32_t index) const { return nodes_[index]; }
    const std::vector<uint32_t>& children(uint32_t index) const { return children_[index]; }
    const std::vector<uint32_t>& roots() const { return roots_; }
    /// Throws the fault of a broken transform on the way to the node.
    const glm::dmat4& toWorld(uint32_t index) const {
        if (const auto broken = broken_.find(index); broken != broken_.end()) throw broken->second;
        return toWorld_[index];
    }

private:
    void findParents() {
        std::vector<uint32_t> parent(size(), kNone);
        for (uint32_t i = 0; i < size(); ++i) {
            const JsonNode list = nodes_[i]["children"];
            for (size_t c = 0; c < list.size(); ++c) {
                const uint32_t child = list[c].index(size(), "/nodes");
                if (parent[child] != kNone) {
                    list[c].fail(
                        fmt::format("/nodes/{} is a child of /nodes/{} already", child, parent[child]));
                }
                parent[child] = i;
                children_[i].push_back(child);
            }
        }
        for (uint32_t i = 0; i < size(); ++i) {
            if (parent[i] == kNone) {
                roots_.push_back(i);
            }
        }
    }

    /// From the roots down. What no root leads to is in a cycle, as every node has at most one parent.
    void compose() {
        std::vector<bool> reached(size(), false);
        std::vector<uint32_t> open = roots_;
        for (uint32_t root : roots_) {
            toWorld_[root] = glm::dmat4(1);
        }
        while (!open.empty()) {
            const uint32_t index = open.back();
            open.pop_back();
            reached[index] = true;
            const bool isBroken = !isSound(index);
            for (uint32_t child : children_[index]) {
                toWorld_[child] = toWorld_[index];
                if (isBroken) broken_.emplace(child, broken_.at(index));
                open.push_back(child);
            }
        }
        for (uint32_t i = 0; i < size(); ++i) {
            if (!reached[i]) {
                nodes_[i].fail("is its own ancestor");
            }
        }
    }

    /// Brings the node's own transform in; a fault, also one of its parents, is for who asks for it.
    bool isSound(uint32_t index) {
        if (broken_.contains(index)) return false;
        const JsonNode node = nodes_[index];
        const std::optional<Error> fault = readIfSound(node, [&] {
            toWorld_[index] = toWorld_[index] * localTransform(node);
            if (!isFinite(toWorld_[index])) {
                node.fail("its transform, with those of its parents, is not finite");
            }
        });
        if (fault) broken_.emplace(index, *fault);
        return !fault;
    }

    JsonNode nodes_;
    std::map<uint32_t, Error> broken_;
    std::vector<std::vector<uint32_t>> children_;
    std::vector<glm::dmat4> toWorld_;
    std::vector<uint32_t> roots_;
};

/// The root nodes of the scene to render.
std::vector<uint32_t> rootsOfScene(const JsonNode& root, const NodeTree& tree) {
    const JsonNode scenes = root["scenes"];
    const JsonNode chosen = root["scene"];
    if (!chosen && scenes.size() == 0) {
        return tree.roots();
    }
    const JsonNode list = scenes[chosen ? chosen.index(scenes.size(), "/scenes") : 0]["nodes"];
    std::vector<uint32_t> roots;
    for (size_t i = 0; i < list.size(); ++i) {
        roots.push_back(list[i].index(tree.size(), "/nodes"));
    }
    return roots;
}

class NodeLoader {
public:
    NodeLoader(LoadContext& load, Meshes& meshes, const PartList<Skin>& skins)
        : load_(load),
          meshes_(meshes),
          skins_(skins),
          tree_(load.file.root()),
          cameras_(parseCameras(load)),
          lights_(parseLights(load)),
          shapes_(load) {}

    void run() {
        std::vector<bool> visited(tree_.size(), false);
        std::vector<uint32_t> open = rootsOfScene(load_.file.root(), tree_);
        std::reverse(open.begin(), open.end());
        while (!open.empty()) {
            const uint32_t index = open.back();
            open.pop_back();
            if (visited[index]) {
                continue;
            }
            visited[index] = true;
            if (!tree_.node(index)["extensions"]["KHR_node_visibility"]["visible"].booleanOr(true)) {
                continue;
            }
            visit(index);
            const auto& children = tree_.children(index);
            open.insert(open.end(), children.rbegin(), children.rend());
        }
    }

private:
    void visit(uint32_t index) {
        const JsonNode node = tree_.node(index);
        const std::string name = node["name"].textOr(fmt::format("nodes/{}", index));
        const glm::dmat4& toWorld = tree_.toWorld(index);
        if (const JsonNode mesh = node["mesh"]) {
            const size_t first = load_.scene.instances.size();
            addInstances(node, mesh.index(meshes_.count(), "/meshes"), toWorld, name);
            for (size_t i = first; i < load_.scene.instances.size(); ++i)
                load_.scene.instances[i].nodeIndex = index;
        }
        if (std::optional<Shape> shape = shapes_.shapeOf(node, toWorld)) {
            meshes_.use(shape->material);
            shape->name = name;
            if (load_.scene.shapes.size() == kMaxInstances)
                node.fail(fmt::format("the scene has more than {} shapes", kMaxInstances));
            load_.scene.shapes.push_back(*std::move(shape));
        }
        if (const JsonNode camera = node["camera"]) {
            Camera placed = cameras_[camera.index(cameras_.size(), "/cameras")];
            placed.node = name;
            placed.name = placed.name.empty() ? name : placed.name;
            placed.toWorld = withoutScale(toWorld);
            load_.scene.cameras.push_back(placed);
        }
        if (const JsonNode light = node["extensions"]["KHR_lights_punctual"]["light"]) {
            addLight(lights_[light.index(lights_.size(), "/extensions/KHR_lights_punctual/lights")], toWorld,
                     name);
        }
    }

    /// A light is as large as it says, whatever the scale of its node.
    void addLight(GltfLight light, const glm::dmat4& toWorld, const std::string& node) {
        const std::string name = light.punctual.name.empty() ? node : light.punctual.name;
        const glm::dmat4 placed = withoutScale(toWorld);
        if (light.area) {
            light.area->name = name;
            light.area->position = glm::dvec3(toWorld[3]);
            light.area->u = glm::dmat3(placed) * light.area->u;
            light.area->v = glm::dmat3(placed) * light.area->v;
            load_.scene.areaLights.push_back(*light.area);
            return;
        }
        light.punctual.name = name;
        light.punctual.position = glm::dvec3(toWorld[3]);
        light.punctual.direction = -glm::dvec3(placed[2]);
        load_.scene.lights.push_back(light.punctual);
    }

    void addInstances(const JsonNode& node, uint32_t mesh, const glm::dmat4& toWorld,
                      const std::string& name) {
        if (const JsonNode skin = node["skin"]) {
            const Skin& bound = skins_[skin.index(skins_.size(), "/skins")];
            if (meshes_.isSkinned(mesh)) {
                return addSkinned(node, mesh, bound, name);
            }
            load_.warn("skins", node, "rendered where its node is: its mesh has no JOINTS_0");
        }
        const std::vector<uint32_t>& parts = meshes_.load(mesh, numbersOf(node["weights"]));
        const JsonNode instancing = node["extensions"]["EXT_mesh_gpu_instancing"];
        std::vector<glm::dmat4> transforms{glm::dmat4(1)};
        if (instancing) {
            transforms = instanceTransforms(instancing);
        }
        if (load_.scene.instances.size() + transforms.size() * parts.size() > kMaxInstances) {
            node.fail(fmt::format("with its instances the scene has more than {}", kMaxInstances));
        }
        for (const glm::dmat4& transform : transforms) {
            for (uint32_t part : parts) {
                load_.scene.instances.push_back({part, instancing ? toWorld * transform : toWorld, name});
                if (!isFinite(load_.scene.instances.back().toWorld)) {
                    instancing.fail("an instance's transform is not finite");
                }
            }
        }
    }

    /// The joints alone place a skinned mesh, wherever its node is. Its vertices are stored around its first
    /// joint, so that a skin far from the origin keeps its precision.
    void addSkinned(const JsonNode& node, uint32_t mesh, const Skin& skin, const std::string& name) {
        glm::dmat4 origin(1);
        origin[3] = tree_.toWorld(skin.joints[0])[3];
        const glm::dmat4 toOrigin = glm::inverse(origin);
        std::vector<glm::dmat4> joints;
        for (size_t i = 0; i < skin.joints.size(); ++i) {
            joints.push_back(toOrigin * tree_.toWorld(skin.joints[i]) * skin.inverseBind[i]);
        }
        if (node["extensions"]["EXT_mesh_gpu_instancing"]) {
            load_.warn("EXT_mesh_gpu_instancing", node, "rendered once, where its skin's joints are");
        }
        for (const uint32_t part : meshes_.loadSkinned(mesh, numbersOf(node["weights"]), joints)) {
            load_.scene.instances.push_back({part, origin, name});
        }
    }

    std::vector<glm::dmat4> instanceTransforms(const JsonNode& instancing) {
        const JsonNode attributes = instancing["attributes"];
        size_t count = 0;
        const auto find = [&](const char* name) -> uint32_t {
            const JsonNode attribute = attributes[name];
            if (!attribute) {
                return kNone;
            }
            const uint32_t accessor = attribute.index(load_.accessors.count(), "/accessors");
            const size_t length = load_.accessors[accessor].count;
            if (length > kMaxInstances || (count != 0 && count != length)) {
                attribute.fail(fmt::format("has {} elements, must have as many as the others and at most {}",
                                           length, kMaxInstances));
            }
            count = length;
            return accessor;
        };
        const uint32_t t = find("TRANSLATION"), r = find("ROTATION"), s = find("SCALE");
        const auto translations = t == kNone ? std::vector(count, glm::vec3(0)) : load_.accessors.vec3s(t);
        const auto rotations =
            r == kNone ? std::vector(count, glm::vec4(0, 0, 0, 1)) : load_.accessors.vec4s(r);
        const auto scales = s == kNone ? std::vector(count, glm::vec3(1)) : load_.accessors.vec3s(s);
        std::vector<glm::dmat4> transforms;
        transforms.reserve(count);
        for (size_t i = 0; i < count; ++i) {
            if (!(glm::length(rotations[i]) > 0)) {
                attributes["ROTATION"].fail(fmt::format("element {} is not a unit quaternion", i));
            }
            transforms.push_back(composeTransform(translations[i], rotations[i], scales[i]));
        }
        return transforms;
    }

    LoadContext& load_;
    Meshes& meshes_;
    const PartList<Skin>& skins_;
    NodeTree tree_;
    PartList<Camera> cameras_;
    PartList<GltfLight> lights_;
    ShapeReader shapes_;
};

}  // namespace

void loadNodes(LoadContext& load, Meshes& meshes, const PartList<Skin>& skins) {
    NodeLoader(load, meshes, skins).run();
}

}  // namespace tilefarm
