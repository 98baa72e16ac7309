#include "worker/scene/load.h"

#include <algorithm>

namespace tilefarm {
namespace {

bool emits(const Scene& scene, const Instance& instance) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const Material& material = scene.materials[mesh.material];
    return !mesh.triangles.empty() && (material.unlit || material.emission != glm::vec3(0));
}

bool hasLight(const Scene& scene) {
    return scene.hasEnvironment() || !scene.lights.empty() ||
           std::any_of(scene.instances.begin(), scene.instances.end(),
                       [&](const Instance& instance) { return emits(scene, instance); });
}

}  // namespace

void lightIfDark(Scene& scene) {
    if (hasLight(scene)) return;
    Image& image = scene.environment.image;
    scene.environment.name = image.name = "constant white";
    image.width = 2;
    image.height = 1;
    image.rgbaFloat.assign(8, 1.f);
    scene.warnings.push_back(
        {"lights", "the scene and the job have none", "lit from everywhere by white light of radiance 1"});
}

}  // namespace tilefarm
