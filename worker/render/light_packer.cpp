#include "worker/render/light_packer.h"

#include <algorithm>
#include <iterator>
#include <span>

#include "gpu_light_packers.h"
#include "worker/render/alias_table.h"
#include "worker/render/lights/light_kinds.h"

namespace tilefarm {
namespace {

void addShapes(const Scene& scene, const WorldGeometry& world, LightList& lights, PackedLights& packed) {
    for (uint32_t i = 0; i < world.shapes.size(); ++i) {
        const Shape& shape = world.shapes[i].shape;
        const EmissiveShape emissive{shape, world.materialOf(scene, shape.material),
                                     world.triangleCount() + i};
        const bool sampled = std::any_of(std::begin(kShapeLights), std::end(kShapeLights),
                                         [&](auto add) { return add(emissive, lights, packed); });
        // Of other shapes that emit, the BSDF finds the light.
        if (!sampled && emissive.material.emission != glm::vec3(0) && !emissive.material.unlit) {
            packed.features |= gpu::bit(gpu::FEATURE_EMISSIVE_TRIANGLES);
            ++packed.counts.lights;
        }
    }
}

void addSurfaces(const Scene& scene, const WorldGeometry& world, LightList& lights, PackedLights& packed) {
    if (world.emissive.empty() && world.quads.empty() && world.shapes.empty()) return;
    packed.primitiveLights.assign(world.primitiveCount(), gpu::NO_INDEX);
    for (const EmissiveTriangle& triangle : world.emissive)
        addTriangle(scene, world, triangle, lights, packed);
    for (const QuadLight& quad : world.quads) {
        const uint32_t index = lights.next();
        if (addQuad(quad, lights, packed))
            packed.primitiveLights[quad.firstTriangle] = packed.primitiveLights[quad.firstTriangle + 1] =
                index;
    }
    if (!world.emissive.empty()) packed.features |= gpu::bit(gpu::FEATURE_EMISSIVE_TRIANGLES);
    addShapes(scene, world, lights, packed);
}

bool wantsTree(const LightList& lights) {
    const auto infinite = static_cast<size_t>(std::count_if(lights.bounds.begin(), lights.bounds.end(),
                                                            [](const LightBounds& b) { return b.infinite; }));
    return lights.bounds.size() >= kLeastLightsForTree || (infinite > 0 && infinite < lights.bounds.size());
}

// One of each group, by power: for every group a table of its own.
void chooseInGroups(const LightList& lights, PackedLights& packed) {
    const std::span powers(lights.powers);
    packed.groups = static_cast<uint32_t>(lights.groups.size());
    for (size_t i = 0; i < lights.groups.size(); ++i) {
        const uint32_t first = lights.groups[i],
                       end = i + 1 < lights.groups.size() ? lights.groups[i + 1] : lights.next();
        for (gpu::AliasRecord entry : buildAliasTable(powers.subspan(first, end - first))) {
            entry.alias += first;
            packed.alias.push_back(entry);
        }
    }
    for (size_t i = 0; i < lights.groups.size(); ++i) packed.alias[i].trail = lights.groups[i];
    packed.features |= gpu::bit(gpu::FEATURE_ALL_LIGHTS);
}

void countLights(const LightList& lights, PackedLights& packed) {
    const auto type = [&](uint32_t light) { return lights.records[light].type; };
    for (const uint32_t first : lights.groups) {
        packed.counts.lights += type(first) != gpu::LIGHT_ENVIRONMENT;
        packed.counts.emissiveGroups += type(first) == gpu::LIGHT_TRIANGLE;
    }
    for (uint32_t i = 0; i < lights.next(); ++i)
        packed.counts.emissiveTriangles += type(i) == gpu::LIGHT_TRIANGLE;
}

void chooseBy(LightSelection selection, const LightList& lights, PackedLights& packed) {
    if (selection == LightSelection::all && lights.groups.size() > 1)
        chooseInGroups(lights, packed);
    else
        packed.alias = buildAliasTable(selection == LightSelection::uniform
                                           ? std::vector<double>(lights.powers.size(), 1.0)
                                           : lights.powers);
    packed.records = lights.records;
    for (size_t i = 0; i < packed.records.size(); ++i) packed.records[i].pmf = packed.alias[i].pmf;
    if (selection != LightSelection::tree || !wantsTree(lights)) return;
    LightTree tree = buildLightTree(lights.bounds);
    packed.tree = std::move(tree.children);
    for (size_t i = 0; i < packed.alias.size(); ++i) packed.alias[i].trail = tree.trails[i];
    packed.features |= gpu::bit(gpu::FEATURE_LIGHT_TREE);
}

}  // namespace

PackedLights packLights(const Scene& scene, const WorldGeometry& world, double environmentFlux,
                        LightSelection selection) {
    PackedLights packed;
    LightList lights;
    const double extent = 0.5 * glm::length(glm::dvec3(world.upper) - glm::dvec3(world.lower));
    const double sceneRadius = extent > 0 ? extent : 1;
    addSurfaces(scene, world, lights, packed);
    for (const PunctualLight& light : world.lights)
        if (!isSun(light)) addPunctual(light, sceneRadius, lights, packed);
    packed.firstSun = lights.next();
    for (const PunctualLight& light : world.lights)
        if (isSun(light)) addSun(light, sceneRadius, lights, packed);
    packed.sunCount = lights.next() - packed.firstSun;
    addEnvironment(environmentFlux, sceneRadius, lights, packed);
    countLights(lights, packed);
    if (!lights.records.empty()) chooseBy(selection, lights, packed);
    return packed;
}

}  // namespace tilefarm
