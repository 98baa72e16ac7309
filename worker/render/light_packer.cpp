#include "worker/render/light_packer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "worker/render/alias_table.h"
#include "worker/render/light_tree.h"
#include "worker/render/texture_average.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

double luminance(const glm::dvec3& c) {
    return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722));
}

// Collects records beside what chooses among them.
struct Lights {
    std::vector<gpu::LightRecord> records;
    std::vector<double> powers;
    std::vector<LightBounds> bounds;
    std::vector<uint32_t> groups;  // first light of each

    /// `object`: lights of one that follow each other are a group.
    bool add(gpu::LightRecord record, const glm::vec3& value, double power, const LightBounds& bound,
             std::optional<uint64_t> object = std::nullopt) {
        if (!(power > 0) || !std::isfinite(power)) return false;
        record.red = value.r;
        record.green = value.g;
        record.blue = value.b;
        if (!object || object != lastObject_) groups.push_back(next());
        lastObject_ = object;
        records.push_back(record);
        powers.push_back(power);
        bounds.push_back(bound);
        return true;
    }
    uint32_t next() const { return static_cast<uint32_t>(records.size()); }

private:
    std::optional<uint64_t> lastObject_;
};

// What the triangles of one mesh at one node have in common; instances that no node places are alone.
uint64_t objectOf(const Scene& scene, const WorldGeometry& world, uint32_t triangle) {
    const uint32_t instance = world.triangleInstance[triangle];
    const bool placed = instance < scene.instances.size() && scene.instances[instance].nodeIndex != kNone;
    return placed ? scene.instances[instance].nodeIndex : uint64_t{kNone} + 1 + instance;
}

// Bounds of a flat emitter: Lambert, so the intensity is greatest along the normal.
LightBounds flatBounds(const std::initializer_list<glm::vec3>& corners, const glm::dvec3& normal,
                       double intensity, bool twoSided) {
    LightBounds b;
    b.lower = b.upper = *corners.begin();
    for (const glm::vec3& corner : corners) {
        b.lower = glm::min(b.lower, glm::dvec3(corner));
        b.upper = glm::max(b.upper, glm::dvec3(corner));
    }
    b.axis = glm::normalize(normal);
    b.thetaE = pi / 2;
    b.intensity = intensity;
    b.twoSided = twoSided;
    return b;
}

void addTriangle(const Scene& scene, const WorldGeometry& world, const EmissiveTriangle& triangle,
                 Lights& lights, PackedLights& packed) {
    const Material& material = world.materialOf(scene, world.instanceOf(triangle.triangle).material);
    if (material.unlit) return;
    const glm::uvec3 corners = world.triangles[triangle.triangle];
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_TRIANGLE;
    record.primitive = triangle.triangle;
    record.area = static_cast<float>(triangle.area);
    record.p = world.positions[corners.x];
    record.a = world.positions[corners.y] - record.p;
    record.b = world.positions[corners.z] - record.p;
    const double intensity = luminance(glm::dvec3(material.emission) *
                                       averageEmission(scene, material, world, triangle.triangle)) *
                             triangle.area;
    const glm::dvec3 normal = glm::cross(glm::dvec3(record.a), glm::dvec3(record.b));
    const uint32_t index = lights.next();
    if (lights.add(record, material.emission, pi * intensity * (material.doubleSided ? 2 : 1),
                   flatBounds({record.p, world.positions[corners.y], world.positions[corners.z]}, normal,
                              intensity, material.doubleSided),
                   objectOf(scene, world, triangle.triangle)))
        packed.primitiveLights[triangle.triangle] = index;
    else
        ++packed.darkTriangles;
}

/// Whether it is a light: it sends out something.
bool addQuad(const QuadLight& quad, Lights& lights, PackedLights& packed) {
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_QUAD;
    record.primitive = quad.twoSided ? 1 : 0;
    record.p = quad.corner;
    record.a = quad.a;
    record.b = quad.b;
    const glm::dvec3 normal = glm::cross(glm::dvec3(quad.a), glm::dvec3(quad.b));
    record.area = static_cast<float>(glm::length(normal));
    const double intensity = luminance(quad.radiance) * glm::length(normal);
    if (!lights.add(record, quad.radiance, pi * intensity * (quad.twoSided ? 2 : 1),
                    flatBounds({quad.corner, quad.corner + quad.a, quad.corner + quad.b,
                                quad.corner + quad.a + quad.b},
                               normal, intensity, quad.twoSided)))
        return false;
    packed.features |= gpu::bit(gpu::FEATURE_QUAD_LIGHTS);
    return true;
}

// Even over the whole surface, whatever way light leaves it.
bool emitsEvenly(const Material& material) {
    return !material.unlit && material.emission != glm::vec3(0) && !material.emissionTexture &&
           material.clearcoat == 0 && (material.alphaMode == AlphaMode::opaque || !material.baseColorTexture);
}

// Of a shape that emits evenly: what leaves it, on average over what is there and what is not.
glm::vec3 coveredEmission(const Material& material) {
    return material.emission * static_cast<float>(coverageOf(material, material.alpha));
}

// Sides at right angles, as the sampling of its solid angle needs them.
bool isQuadLight(const Shape& shape, const Material& material) {
    const glm::dvec3 u(shape.toWorld[0]), v(shape.toWorld[1]);
    return shape.kind == ShapeKind::rectangle && emitsEvenly(material) &&
           std::abs(glm::dot(u, v)) <= 1e-6 * glm::length(u) * glm::length(v);
}

QuadLight quadOf(const Shape& shape, const Material& material) {
    glm::dvec3 u = shape.size.x * glm::dvec3(shape.toWorld[0]),
               v = shape.size.y * glm::dvec3(shape.toWorld[1]);
    // A mirror image keeps its front.
    if (glm::determinant(glm::dmat3(shape.toWorld)) < 0) std::swap(u, v);
    QuadLight quad;
    quad.corner = glm::dvec3(shape.toWorld[3]) - u - v;
    quad.a = 2.0 * u;
    quad.b = 2.0 * v;
    quad.radiance = coveredEmission(material);
    quad.twoSided = material.doubleSided;
    return quad;
}

// Spheres that are round in the world and emit evenly. Of other shapes that emit, the BSDF finds the light.
bool isSphereLight(const Shape& shape, const Material& material) {
    return shape.kind == ShapeKind::sphere && isSimilarity(shape.toWorld) && emitsEvenly(material) &&
           material.doubleSided;
}

void addSphere(const Shape& shape, const Material& material, uint32_t primitive, Lights& lights,
               PackedLights& packed) {
    const glm::dvec3 centre(shape.toWorld[3]);
    const double radius = shape.size.x * glm::length(glm::dvec3(shape.toWorld[0]));
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_SPHERE;
    record.primitive = primitive;
    record.p = glm::vec3(centre);
    record.a.x = static_cast<float>(radius);
    record.area = static_cast<float>(4 * pi * radius * radius);
    LightBounds bounds;
    bounds.lower = centre - radius;
    bounds.upper = centre + radius;
    bounds.thetaO = pi;
    bounds.thetaE = pi / 2;
    const glm::vec3 emission = coveredEmission(material);
    bounds.intensity = luminance(emission) * pi * radius * radius;
    const uint32_t index = lights.next();
    if (!lights.add(record, emission, 4 * pi * bounds.intensity, bounds)) return;
    packed.primitiveLights[primitive] = index;
    packed.features |= gpu::bit(gpu::FEATURE_SPHERE_LIGHTS);
}

void addShapes(const Scene& scene, const WorldGeometry& world, Lights& lights, PackedLights& packed) {
    for (uint32_t i = 0; i < world.shapes.size(); ++i) {
        const Shape& shape = world.shapes[i].shape;
        const Material& material = world.materialOf(scene, shape.material);
        const uint32_t index = lights.next(), primitive = world.triangleCount() + i;
        if (isQuadLight(shape, material)) {
            if (addQuad(quadOf(shape, material), lights, packed)) packed.primitiveLights[primitive] = index;
        } else if (isSphereLight(shape, material)) {
            addSphere(shape, material, primitive, lights, packed);
        } else if (material.emission != glm::vec3(0) && !material.unlit) {
            packed.features |= gpu::bit(gpu::FEATURE_EMISSIVE_TRIANGLES);
            ++packed.counts.lights;
        }
    }
}

void addSurfaces(const Scene& scene, const WorldGeometry& world, Lights& lights, PackedLights& packed) {
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

// Below 1e-6 rad fp32 directions cannot tell the disk's inside from its outside: such a light is a delta.
bool isSun(const PunctualLight& light) {
    return light.type == PunctualType::directional && light.angularRadius >= 1e-6f;
}

void addPunctual(const PunctualLight& light, double sceneRadius, Lights& lights, PackedLights& packed) {
    gpu::LightRecord record{};
    record.primitive = gpu::NO_INDEX;
    record.p = glm::vec3(light.position);
    record.a = light.direction;
    record.b = {std::cos(light.innerCone), std::cos(light.outerCone), light.range};
    LightBounds bounds;
    bounds.lower = bounds.upper = record.p;
    bounds.axis = light.direction;
    bounds.intensity = luminance(glm::dvec3(light.color));
    double power = 0;
    switch (light.type) {
        case PunctualType::point:
            record.type = gpu::LIGHT_POINT;
            bounds.thetaO = pi;
            bounds.thetaE = pi / 2;
            power = 4 * pi * bounds.intensity;
            break;
        case PunctualType::spot:
            record.type = gpu::LIGHT_SPOT;
            bounds.thetaO = light.innerCone;
            bounds.thetaE = std::max(light.outerCone - light.innerCone, 0.f);
            power = std::max(2 * pi * (1 - std::cos(light.outerCone)), 1e-9) * bounds.intensity;
            break;
        case PunctualType::directional:
            record.type = gpu::LIGHT_DIRECTIONAL;
            bounds.infinite = true;
            bounds.axis = -light.direction;
            power = pi * sceneRadius * sceneRadius * bounds.intensity;
            break;
    }
    if (lights.add(record, light.color, power, bounds))
        packed.features |= gpu::bit(gpu::FEATURE_PUNCTUAL_LIGHTS);
}

// A disk of even radiance that gives a plane across its axis the irradiance `color`: E = π L sin² θmax.
void addSun(const PunctualLight& light, double sceneRadius, Lights& lights, PackedLights& packed) {
    const double theta = std::min(double{light.angularRadius}, pi / 2), half = std::sin(theta / 2);
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_SUN;
    record.primitive = gpu::NO_INDEX;
    record.a = light.direction;
    record.b.x = static_cast<float>(2 * half * half);
    LightBounds bounds;
    bounds.infinite = true;
    bounds.axis = -light.direction;
    bounds.thetaO = theta;
    bounds.intensity = luminance(glm::dvec3(light.color));
    const glm::dvec3 radiance = glm::dvec3(light.color) / (pi * std::sin(theta) * std::sin(theta));
    if (lights.add(record, radiance, pi * sceneRadius * sceneRadius * bounds.intensity, bounds))
        packed.features |= gpu::bit(gpu::FEATURE_SUN_LIGHTS);
}

void addEnvironment(double flux, double sceneRadius, Lights& lights, PackedLights& packed) {
    if (!(flux > 0)) return;
    gpu::LightRecord record{};
    record.type = gpu::LIGHT_ENVIRONMENT;
    record.primitive = gpu::NO_INDEX;
    LightBounds bounds;
    bounds.infinite = true;
    bounds.thetaO = pi;
    bounds.intensity = flux / 4;  // irradiance, averaged over the orientations of a plane
    const uint32_t index = lights.next();
    if (!lights.add(record, glm::vec3(0), pi * sceneRadius * sceneRadius * flux, bounds)) return;
    packed.environmentLight = index;
    packed.features |= gpu::bit(gpu::FEATURE_ENVIRONMENT);
}

bool wantsTree(const Lights& lights) {
    const auto infinite = static_cast<size_t>(std::count_if(lights.bounds.begin(), lights.bounds.end(),
                                                            [](const LightBounds& b) { return b.infinite; }));
    return lights.bounds.size() >= kLeastLightsForTree || (infinite > 0 && infinite < lights.bounds.size());
}

// One of each group, by power: for every group a table of its own.
void chooseInGroups(const Lights& lights, PackedLights& packed) {
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

void countLights(const Lights& lights, PackedLights& packed) {
    const auto type = [&](uint32_t light) { return lights.records[light].type; };
    for (const uint32_t first : lights.groups) {
        packed.counts.lights += type(first) != gpu::LIGHT_ENVIRONMENT;
        packed.counts.emissiveGroups += type(first) == gpu::LIGHT_TRIANGLE;
    }
    for (uint32_t i = 0; i < lights.next(); ++i)
        packed.counts.emissiveTriangles += type(i) == gpu::LIGHT_TRIANGLE;
}

void chooseBy(LightSelection selection, const Lights& lights, PackedLights& packed) {
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
    Lights lights;
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
