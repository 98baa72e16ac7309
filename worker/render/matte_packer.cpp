#include "worker/render/matte_packer.h"

#include "shared/matte/cryptomatte.h"
#include "shared/matte/scene_names.h"

namespace tilefarm {
namespace {

// The last material of a scene is that of primitives without one, those behind it are of area lights; then
// come thin ones, which go by the name of what they stand for.
std::vector<uint32_t> materialIds(const Scene& scene, const WorldGeometry& world) {
    std::vector<uint32_t> ids;
    for (size_t i = 0; i < scene.materials.size(); ++i)
        ids.push_back(matteId(materialName(scene.materials[i].name, i)));
    ids.resize(ids.size() + world.lightMaterials.size(), matteId(kLightMaterialName));
    for (const ThinMaterial& thin : world.thinMaterials) ids.push_back(ids[thin.of]);
    return ids;
}

}  // namespace

std::vector<glm::uvec4> packMattes(const Scene& scene, const WorldGeometry& world) {
    const std::vector<uint32_t> materials = materialIds(scene, world);
    const auto lightId = [&](size_t light) { return matteId(lightName(scene.areaLights[light].name)); };
    std::vector<glm::uvec2> ids(world.primitiveCount());
    for (size_t i = 0; i < world.instances.size(); ++i) {
        const WorldInstance& range = world.instances[i];
        const uint32_t object = i < scene.instances.size() ? matteId(scene.instances[i].node)
                                                           : lightId(range.material - scene.materials.size());
        std::fill_n(ids.begin() + range.firstTriangle, range.triangleCount,
                    glm::uvec2(object, materials[range.material]));
    }
    for (size_t i = 0; i < world.shapes.size(); ++i) {
        const WorldShape& shape = world.shapes[i];
        const uint32_t object =
            shape.areaLight == kNone ? matteId(shape.shape.name) : lightId(shape.areaLight);
        ids[world.triangleCount() + i] = {object, materials[shape.shape.material]};
    }
    ids.resize((ids.size() + 1) / 2 * 2);
    std::vector<glm::uvec4> texels;
    for (size_t i = 0; i < ids.size(); i += 2) texels.emplace_back(ids[i], ids[i + 1]);
    return texels;
}

}  // namespace tilefarm
