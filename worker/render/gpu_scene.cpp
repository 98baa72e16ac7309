#include "worker/render/gpu_scene.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "worker/render/coincidence.h"
#include "worker/render/environment_packer.h"
#include "worker/render/light_packer.h"
#include "worker/render/material_packer.h"
#include "worker/render/matte_packer.h"
#include "worker/render/shape_packer.h"
#include "worker/render/vertex_packer.h"
#include "worker/scene/back_faces.h"

namespace tilefarm {
namespace {

using gpu::TexelFormat;

double secondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<bool> usedMaterials(const Scene& scene, const WorldGeometry& world) {
    std::vector<bool> used(world.materialCount(scene));
    for (const WorldInstance& instance : world.instances)
        if (instance.triangleCount > 0) used[instance.material] = true;
    for (const WorldShape& shape : world.shapes) used[shape.shape.material] = true;
    return used;
}

std::vector<uint32_t> shapeSlotsOf(const Bvh& bvh) {
    std::vector<uint32_t> slots;
    for (uint32_t i = 0; i < bvh.triangleCount; ++i)
        if ((bvh.triangles[size_t{i} * kBvhTriangleTexels].w & kBvhShape) != 0)
            slots.push_back(i * kBvhTriangleTexels);
    return slots;
}

// Four indices to a texel.
std::vector<uint32_t> padded(std::vector<uint32_t> indices) {
    indices.resize((indices.size() + 3) / 4 * 4, gpu::NO_INDEX);
    return indices;
}

// Vertex data that no effect reads is not stored.
uint64_t geometryFeatures(const WorldGeometry& world) {
    const bool fields = std::any_of(world.shapes.begin(), world.shapes.end(), [](const WorldShape& shape) {
        return shape.shape.kind == ShapeKind::field;
    });
    return (fields ? gpu::bit(gpu::FEATURE_FIELDS) : 0u) |
           (world.colors.empty() ? 0u : gpu::bit(gpu::FEATURE_VERTEX_COLORS)) |
           (world.shapes.empty() ? 0u : gpu::bit(gpu::FEATURE_SHAPES));
}

// What traversal has to know of each primitive; empty where that is nothing.
std::vector<uint8_t> primitiveFlags(const Scene& scene, const WorldGeometry& world, Culling culling) {
    std::vector<uint8_t> result;
    const auto add = [&](size_t first, size_t count, uint32_t material, bool cullable) {
        const bool asks = world.materialOf(scene, material).alphaMode != AlphaMode::opaque;
        const bool culled = cullable && culling != Culling::none;
        const auto flags = static_cast<uint8_t>((asks ? kAsksAccept : 0) | (culled ? kIsSingleSided : 0));
        if (flags == 0) return;
        result.resize(world.primitiveCount());
        std::fill_n(result.begin() + static_cast<std::ptrdiff_t>(first), count, flags);
    };
    for (const WorldInstance& instance : world.instances)
        add(instance.firstTriangle, instance.triangleCount, instance.material, isCullable(scene, instance));
    for (size_t i = 0; i < world.shapes.size(); ++i)
        add(world.triangleCount() + i, 1, world.shapes[i].shape.material, isCullable(scene, world.shapes[i]));
    return result;
}

// Effects that the settings ask for by themselves, and the environment's.
uint64_t lightingFeatures(const RenderSettings& settings, const Environment& environment) {
    uint64_t features = 0;
    if (settings.directLight != DirectLight::mis) features |= gpu::bit(gpu::FEATURE_SINGLE_SAMPLING);
    if (environment.image.width != 0 && environment.rotation != 0)
        features |= gpu::bit(gpu::FEATURE_ENVIRONMENT_ROTATION);
    if (!environment.visible) features |= gpu::bit(gpu::FEATURE_HIDDEN_ENVIRONMENT);
    return features;
}

// Cheap integrators ask all lights in any case, each in its middle.
LightSelection selectionOf(const RenderSettings& settings) {
    const bool groups =
        settings.lightSelection == LightSelection::all && settings.integrator == Integrator::path;
    return groups || settings.lightSelection != LightSelection::all ? settings.lightSelection
                                                                    : LightSelection::uniform;
}

uint32_t lightRules(const RenderSettings& settings, const PackedLights& lights) {
    uint32_t rules = 0;
    if (!lights.tree.empty()) rules |= gpu::LIGHTS_BY_TREE;
    if (lights.groups > 0) rules |= gpu::LIGHTS_ALL;
    if (settings.directLight == DirectLight::lights) rules |= gpu::LIGHTS_ALONE;
    if (settings.directLight == DirectLight::bsdf) rules |= gpu::LIGHTS_BY_BSDF;
    return rules;
}

class Uploader {
public:
    Uploader(const gpu::Device& device, std::vector<gpu::TexelBuffer>& buffers, const GpuScene* like)
        : device_(device), buffers_(buffers), like_(like) {}

    /// `same`: the buffer is that of `like`, if there is one.
    template <typename T>
    void add(TexelFormat format, const std::vector<T>& values, const char* name, bool same = false) {
        if (like_ && same)
            buffers_.push_back(like_->buffers[buffers_.size()]);
        else
            buffers_.emplace_back(device_, format, gpu::bytesOf(values), name);
    }

private:
    const gpu::Device& device_;
    std::vector<gpu::TexelBuffer>& buffers_;
    const GpuScene* like_;
};

void takeEnvironment(GpuScene& scene, const PackedEnvironment& packed, const GpuScene* like) {
    scene.environmentWidth = like ? like->environmentWidth : packed.width;
    scene.environmentHeight = like ? like->environmentHeight : packed.height;
    scene.environmentWeightSum = like ? like->environmentWeightSum : packed.weightSum;
    scene.environmentFlux = like ? like->environmentFlux : packed.flux();
}

}  // namespace

GpuScene makeGpuScene(const gpu::Device& device, const Scene& scene, const WorldGeometry& world,
                      const RenderSettings& settings, uint64_t extraFeatures, PrepareTimes& times,
                      const GpuScene* like) {
    const auto start = std::chrono::steady_clock::now();
    const Bvh bvh =
        buildBvh(world.corners(), primitiveFlags(scene, world, settings.culling), shapeBoxes(world.shapes));
    const Coincidence coincidence = findCoincidence(bvh, scene, world);
    times.bvhSeconds += secondsSince(start);

    TexturePacker textures(scene);
    MaterialPacker materials(textures, settings);
    const std::vector<bool> used = usedMaterials(scene, world);
    for (uint32_t i = 0; i < used.size(); ++i) materials.add(world.materialOf(scene, i), used[i]);
    for (size_t i = 0; i < used.size(); ++i)
        if (coincidence.interfaces[i]) materials.records[i].flags |= gpu::MATERIAL_COINCIDENT;
    GpuScene result;
    const PackedEnvironment environment = like ? PackedEnvironment{} : packEnvironment(scene.environment);
    takeEnvironment(result, environment, like);
    result.images = textures.images;
    result.fog = placeFog(scene.fog, world);
    result.solids = Solids(scene, world);
    PackedLights lights = packLights(scene, world, result.environmentFlux, selectionOf(settings));

    result.features = materials.features | textures.features | lights.features | geometryFeatures(world) |
                      lightingFeatures(settings, scene.environment) |
                      (coincidence.any ? gpu::bit(gpu::FEATURE_COINCIDENT_FACES) : 0u) |
                      (scene.fog ? gpu::bit(gpu::FEATURE_FOG) : 0u) | extraFeatures;
    result.vertexTexels = vertexTexelsFor(result.features);
    result.triangles = world.triangleCount();
    result.stackSize = bvhStackConstant(bvh);
    result.slots = bvh.triangleCount;
    if (!world.shapes.empty()) result.shapeSlots = shapeSlotsOf(bvh);
    result.lightCount = static_cast<uint32_t>(lights.records.size());
    result.lightGroups = lights.groups;
    result.lightRules = lightRules(settings, lights);
    result.lights = lights.counts;
    result.environmentLight = lights.environmentLight;
    const double turns = scene.environment.rotation / (2 * std::numbers::pi);
    result.environmentTurns = turns - std::floor(turns);
    result.environmentHidden = !scene.environment.visible;
    result.firstSun = lights.firstSun;
    result.sunCount = lights.sunCount;

    const auto upload = std::chrono::steady_clock::now();
    Uploader to(device, result.buffers, like);
    const bool sameImages = like && like->images == result.images;
    to.add(TexelFormat::rgba32ui, bvh.nodes, "BVH nodes");
    to.add(TexelFormat::rgba32ui, bvh.triangles, "triangles");
    to.add(TexelFormat::rgba32ui, packPrimitives(world), "primitives");
    to.add(TexelFormat::rgba32ui, packVertices(world, result.vertexTexels), "vertices");
    to.add(TexelFormat::rgba32ui, materials.records, "materials");
    to.add(TexelFormat::rgba32ui, textures.records, "texture records");
    to.add(TexelFormat::rgba8unorm, textures.texels8, "8-bit texels", sameImages);
    to.add(TexelFormat::rgba32f, textures.texels32, "float texels", sameImages);
    to.add(TexelFormat::rgba32ui, lights.records, "lights");
    to.add(TexelFormat::rgba32ui, lights.alias, "light alias table");
    to.add(TexelFormat::rgba32ui, padded(std::move(lights.primitiveLights)), "lights of primitives");
    to.add(TexelFormat::rgba32f, environment.texels, "environment", true);
    to.add(TexelFormat::rgba32ui, environment.alias, "environment alias table", true);
    to.add(TexelFormat::rgba32f, materials.albedoTables, "albedo tables");
    to.add(TexelFormat::rgba32ui, lights.tree, "light tree");
    to.add(TexelFormat::rgba32ui, packShapes(world.shapes), "shapes");
    const bool mattes = (result.features & gpu::bit(gpu::FEATURE_CRYPTOMATTE)) != 0 ||
                        settings.integrator == Integrator::object;
    to.add(TexelFormat::rgba32ui, mattes ? packMattes(scene, world) : std::vector<glm::uvec4>{}, "mattes");
    times.uploadSeconds += secondsSince(upload);
    return result;
}

void setLights(gpu::FrameParameters& p, const GpuScene& scene) {
    p.lightCount = scene.lightCount;
    p.environmentLight = scene.environmentLight;
    p.lightSelection = scene.lightRules;
    p.lightGroups = scene.lightGroups;
    p.environmentSize = {scene.environmentWidth, scene.environmentHeight};
    p.firstSun = scene.firstSun;
    p.sunCount = scene.sunCount;
    p.environmentHidden = scene.environmentHidden ? 1.f : 0.f;
    if (scene.environmentWeightSum > 0) {
        const double texels = double(scene.environmentWidth) * scene.environmentHeight;
        p.environmentInverseWeight = static_cast<float>(1 / scene.environmentWeightSum);
        p.environmentTexelsPerSteradian = static_cast<float>(texels / (2 * std::numbers::pi * std::numbers::pi));
        p.environmentTurns = static_cast<float>(scene.environmentTurns);
    }
}

}  // namespace tilefarm
