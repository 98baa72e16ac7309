#include "worker/scene/load.h"

#include <algorithm>

namespace tilefarm {
namespace {

/// The largest of a channel in an image, 1 where there is none.
float largest(const Scene& scene, const TextureRef& texture, size_t channel) {
    if (!texture) return 1;
    const Image& image = scene.images[texture.image];
    const auto of = [channel](const auto& texels) {
        float most = 0;
        for (size_t i = channel; i < texels.size(); i += 4)
            most = std::max(most, static_cast<float>(texels[i]));
        return most;
    };
    return image.rgba8.empty() ? of(image.rgbaFloat) : of(image.rgba8) / 255;
}

/// Whether anything of the surface is there: all of one that its alpha cuts out or fades to nothing is not.
bool isThere(const Scene& scene, const Material& material, float vertexAlpha) {
    if (material.alphaMode == AlphaMode::opaque) return true;
    const float alpha = material.alpha * vertexAlpha * largest(scene, material.baseColorTexture, 3);
    return material.alphaMode == AlphaMode::mask ? alpha >= material.alphaCutoff : alpha > 0;
}

/// An unlit material only looks bright: it lights nothing.
bool emits(const Scene& scene, const Material& material, float vertexAlpha) {
    if (material.unlit || !isThere(scene, material, vertexAlpha)) return false;
    for (int c = 0; c < 3; ++c) {
        if (material.emission[c] > 0 &&
            largest(scene, material.emissionTexture, static_cast<size_t>(c)) > 0) {
            return true;
        }
    }
    return false;
}

/// Whether some triangle has an area in the world.
bool hasArea(const Mesh& mesh, const glm::dmat4& toWorld) {
    const auto at = [&](uint32_t corner) {
        return glm::dvec3(toWorld * glm::dvec4(mesh.positions[corner], 1));
    };
    return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const glm::uvec3& t) {
        return glm::length(glm::cross(at(t.y) - at(t.x), at(t.z) - at(t.x))) > 0;
    });
}

bool emits(const Scene& scene, const Instance& instance) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    float alpha = mesh.colors.empty() ? 1.0f : 0.0f;
    for (const glm::vec4& color : mesh.colors) alpha = std::max(alpha, color.w);
    const Material& material = scene.materials[mesh.material];
    return material.emission != glm::vec3(0) && emits(scene, material, alpha) &&
           (scene.sizesChange || hasArea(mesh, instance.toWorld));
}

bool shines(const PunctualLight& light) {
    return light.color != glm::vec3(0) && !(light.type == PunctualType::spot && light.outerCone <= 0);
}

bool shines(const AreaLight& light) {
    return light.radiance != glm::vec3(0) &&
           (light.shape == AreaShape::sphere ? light.radius > 0
                                             : glm::length(glm::cross(light.u, light.v)) > 0);
}

bool hasLight(const Scene& scene) {
    if (scene.hasEnvironment() || scene.lightChanges) return true;
    const auto lit = [&](const Shape& shape) {
        return (scene.sizesChange || isProper(shape)) && emits(scene, scene.materials[shape.material], 1);
    };
    const auto emitting = [&](const Instance& instance) { return emits(scene, instance); };
    const auto shining = [](const auto& light) { return shines(light); };
    return std::any_of(scene.lights.begin(), scene.lights.end(), shining) ||
           std::any_of(scene.areaLights.begin(), scene.areaLights.end(), shining) ||
           std::any_of(scene.instances.begin(), scene.instances.end(), emitting) ||
           std::any_of(scene.shapes.begin(), scene.shapes.end(), lit);
}

/// Whether all that there is to see is unlit: it shows its colours without light, so the file lacks none.
bool isUnlit(const Scene& scene) {
    const auto unlit = [&](uint32_t material) { return scene.materials[material].unlit; };
    return !(scene.instances.empty() && scene.shapes.empty()) &&
           std::all_of(
               scene.instances.begin(), scene.instances.end(),
               [&](const Instance& instance) { return unlit(scene.meshes[instance.mesh].material); }) &&
           std::all_of(scene.shapes.begin(), scene.shapes.end(),
                       [&](const Shape& shape) { return unlit(shape.material); });
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
    if (hasLight(scene) || isUnlit(scene)) return;
    scene.environment = constantEnvironment(glm::vec3(1));
    scene.environment.name = scene.environment.image.name = "constant white";
    scene.warnings.push_back({"lights", "nothing in the scene or the job shines",
                              "lit from everywhere by white light of radiance 1"});
}

}  // namespace tilefarm
