#include "worker/render/hidden_lights.h"

#include <algorithm>
#include <set>

#include "worker/render/interface_packer.h"

namespace tilefarm {
namespace {

bool hasNoExtent(const PunctualLight& light) {
    return light.color != glm::vec3(0) &&
           (light.type != PunctualType::directional || light.angularRadius == 0);
}

/// Of what encloses something.
std::set<uint32_t> materialsOfSolids(const Scene& scene) {
    std::set<uint32_t> materials;
    for (const Instance& instance : scene.instances)
        if (const Mesh& mesh = scene.meshes[instance.mesh]; !mesh.open) materials.insert(mesh.material);
    for (const Shape& shape : scene.shapes)
        if (!isFlat(shape.kind)) materials.insert(shape.material);
    return materials;
}

std::string labelOf(const Scene& scene, uint32_t material) {
    const std::string& name = scene.materials[material].name;
    return "materials/" + std::to_string(material) + (name.empty() ? "" : " (" + name + ")");
}

}  // namespace

std::vector<SceneWarning> hiddenLights(const Scene& scene, const RenderSettings& settings) {
    std::vector<SceneWarning> warnings;
    const bool shadows =
        settings.integrator == Integrator::path || settings.integrator == Integrator::whitted;
    if (!shadows || std::none_of(scene.lights.begin(), scene.lights.end(), hasNoExtent)) return warnings;
    for (const uint32_t material : materialsOfSolids(scene))
        if (hidesLights(scene.materials[material], settings))
            warnings.push_back({"lights without extent", labelOf(scene, material),
                                "they cannot be found through smooth solid glass, whose shadow is too dark; "
                                "numerics.lightsBehindGlass of the report counts the blocked shadow rays"});
    return warnings;
}

}  // namespace tilefarm
