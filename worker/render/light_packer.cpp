#include "worker/render/light_packer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/render/alias_table.h"
#include "worker/render/texture_average.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

double luminance(const glm::dvec3& c) {
    return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722));
}

// Collects records beside the weights that choose among them.
struct Lights {
    std::vector<gpu::LightRecord> records;
    std::vector<double> powers;

    bool add(gpu::LightRecord record, const glm::vec3& value, double power) {
        if (!(power > 0) || !std::isfinite(power)) return false;
        record.red = value.r;
        record.green = value.g;
        record.blue = value.b;
        records.push_back(record);
        powers.push_back(power);
        return true;
    }
};

gpu::LightRecord triangleRecord(const WorldGeometry& world, const EmissiveTriangle& triangle) {
    const glm::uvec3 corners = world.triangles[triangle.triangle];
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_TRIANGLE;
    record.primitive = triangle.triangle;
    record.area = static_cast<float>(triangle.area);
    record.p = world.positions[corners.x];
    record.a = world.positions[corners.y] - record.p;
    record.b = world.positions[corners.z] - record.p;
    return record;
}

void addTriangles(const Scene& scene, const WorldGeometry& world, Lights& lights, PackedLights& packed) {
    if (world.emissive.empty()) return;
    packed.primitiveLights.assign(world.primitiveCount(), gpu::NO_INDEX);
    for (const EmissiveTriangle& triangle : world.emissive) {
        const Material& material = scene.materials[world.instanceOf(triangle.triangle).material];
        if (material.unlit) continue;
        const glm::dvec3 radiance =
            glm::dvec3(material.emission) *
            averageOverTriangle(scene, material.emissionTexture, world, triangle.triangle);
        const double power = luminance(radiance) * triangle.area * pi * (material.doubleSided ? 2 : 1);
        const auto index = static_cast<uint32_t>(lights.records.size());
        if (lights.add(triangleRecord(world, triangle), material.emission, power))
            packed.primitiveLights[triangle.triangle] = index;
        else
            ++packed.darkTriangles;
    }
    packed.features |= gpu::bit(gpu::FEATURE_EMISSIVE_TRIANGLES);
}

double punctualPower(const PunctualLight& light, double sceneRadius) {
    const double intensity = luminance(glm::dvec3(light.color));
    switch (light.type) {
        case PunctualType::point: return 4 * pi * intensity;
        case PunctualType::spot: return std::max(2 * pi * (1 - std::cos(light.outerCone)), 1e-9) * intensity;
        case PunctualType::directional: return pi * sceneRadius * sceneRadius * intensity;
    }
    return 0;
}

void addPunctual(const WorldGeometry& world, double sceneRadius, Lights& lights, PackedLights& packed) {
    for (const PunctualLight& light : world.lights) {
        gpu::LightRecord record{};
        record.type = light.type == PunctualType::point  ? gpu::LIGHT_POINT
                      : light.type == PunctualType::spot ? gpu::LIGHT_SPOT
                                                         : gpu::LIGHT_DIRECTIONAL;
        record.primitive = gpu::NO_INDEX;
        record.p = glm::vec3(light.position);
        record.a = light.direction;
        record.b = {std::cos(light.innerCone), std::cos(light.outerCone), light.range};
        if (lights.add(record, light.color, punctualPower(light, sceneRadius)))
            packed.features |= gpu::bit(gpu::FEATURE_PUNCTUAL_LIGHTS);
    }
}

}  // namespace

PackedLights packLights(const Scene& scene, const WorldGeometry& world, double environmentFlux) {
    PackedLights packed;
    Lights lights;
    const double extent = 0.5 * glm::length(glm::dvec3(world.upper) - glm::dvec3(world.lower));
    const double sceneRadius = extent > 0 ? extent : 1;
    addTriangles(scene, world, lights, packed);
    addPunctual(world, sceneRadius, lights, packed);
    if (environmentFlux > 0) {
        gpu::LightRecord record{};
        record.type = gpu::LIGHT_ENVIRONMENT;
        record.primitive = gpu::NO_INDEX;
        packed.environmentLight = static_cast<uint32_t>(lights.records.size());
        lights.add(record, glm::vec3(0), pi * sceneRadius * sceneRadius * environmentFlux);
        packed.features |= gpu::bit(gpu::FEATURE_ENVIRONMENT);
    }
    if (lights.records.empty()) return packed;
    packed.alias = buildAliasTable(lights.powers);
    packed.records = std::move(lights.records);
    for (size_t i = 0; i < packed.records.size(); ++i) packed.records[i].pmf = packed.alias[i].pmf;
    return packed;
}

}  // namespace tilefarm
