#include "worker/render/fog_parameters.h"

namespace tilefarm {
namespace {

Fog::Box boxAround(const std::optional<Fog::Box>& surfaces, const CameraPath& camera) {
    const glm::dvec3 first(camera.keys.front().toWorld[3]);
    Fog::Box box = surfaces.value_or(Fog::Box{first, first});
    for (const Camera& key : camera.keys) {
        const glm::dvec3 eye(key.toWorld[3]);
        box.lower = glm::min(box.lower, eye - double{key.apertureRadius});
        box.upper = glm::max(box.upper, eye + double{key.apertureRadius});
    }
    return box;
}

}  // namespace

PlacedFog placeFog(const Fog& fog, const WorldGeometry& world) {
    PlacedFog placed{fog, std::nullopt};
    if (fog.box) placed.fog.box = Fog::Box{fog.box->lower - world.centre, fog.box->upper - world.centre};
    if (world.primitiveCount() > 0) placed.surfaces = Fog::Box{world.lower, world.upper};
    return placed;
}

void setFog(gpu::FrameParameters& parameters, const PlacedFog& placed, const CameraPath& camera) {
    const Fog& fog = placed.fog;
    if (!fog) return;
    const Fog::Box box = fog.box ? *fog.box : boxAround(placed.surfaces, camera);
    parameters.fogLower = glm::vec3(box.lower);
    parameters.fogAnisotropy = static_cast<float>(fog.anisotropy);
    parameters.fogUpper = glm::vec3(box.upper);
    parameters.fogPresent = 1;
    parameters.fogScattering = glm::vec3(fog.extinction * fog.albedo);
    // From 1 − albedo in double: exactly 0 where all is scattered.
    parameters.fogAbsorption = glm::vec3(fog.extinction * (1.0 - fog.albedo));
}

}  // namespace tilefarm
