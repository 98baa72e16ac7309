#include "worker/scene/load.h"

#include <algorithm>

namespace tilefarm {
namespace {

bool emits(const Material& material) {
    return material.unlit || material.emission != glm::vec3(0);
}

bool emits(const Scene& scene, const Instance& instance) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    return !mesh.triangles.empty() && emits(scene.materials[mesh.material]);
}

bool hasLight(const Scene& scene) {
    return scene.hasEnvironment() || !scene.lights.empty() || !scene.areaLights.empty() ||
           std::any_of(scene.instances.begin(), scene.instances.end(),
                       [&](const Instance& instance) { return emits(scene, instance); }) ||
           std::any_of(scene.shapes.begin(), scene.shapes.end(),
                       [&](const Shape& shape) { return emits(scene.materials[shape.material]); });
}

}  // namespace

Environment constantEnvironment(const glm::vec3& color) {
    Environment environment;
    environment.name = environment.image.name = "constant";
    environment.image.width = 2;
    environment.image.height = 1;
    environment.image.rgbaFloat = {color.r, color.g, color.b, 1, color.r, color.g, color.b, 1};
    return environment;
}

void lightIfDark(Scene& scene) {
    if (hasLight(scene)) return;
    scene.environment = constantEnvironment(glm::vec3(1));
    scene.environment.name = scene.environment.image.name = "constant white";
    scene.warnings.push_back(
        {"lights", "the scene and the job have none", "lit from everywhere by white light of radiance 1"});
}

}  // namespace tilefarm
