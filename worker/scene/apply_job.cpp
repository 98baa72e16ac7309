#include "worker/scene/apply_job.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "shared/job/bundle_paths.h"
#include "shared/job/job.h"
#include "worker/scene/load.h"
#include "worker/scene/sky.h"
#include "worker/scene/vectors.h"

namespace tilefarm {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

glm::vec3 emitted(const LightSettings& light) {
    return glm::dvec3(light.color[0], light.color[1], light.color[2]) * light.intensity;
}

PunctualLight punctual(const LightSettings& given, PunctualType type) {
    PunctualLight light;
    light.type = type;
    light.name = given.name;
    light.color = emitted(given);
    light.position = vectorOf(given.position);
    light.direction = glm::normalize(vectorOf(given.direction));
    light.innerCone = static_cast<float>(given.innerCone * kDegree);
    light.outerCone = static_cast<float>(given.outerCone * kDegree);
    light.angularRadius = static_cast<float>(given.angularDiameter / 2 * kDegree);
    return light;
}

/// A quad's width lies level unless it shines straight up or down, then along x.
AreaLight quad(const LightSettings& given) {
    AreaLight light;
    light.shape = AreaShape::quad;
    light.name = given.name;
    light.position = vectorOf(given.position);
    light.radiance = emitted(given);
    light.twoSided = given.twoSided;
    const glm::dvec3 normal = glm::normalize(vectorOf(given.direction));
    const glm::dvec3 level = glm::cross(glm::dvec3(0, 1, 0), normal);
    const glm::dvec3 u = glm::length(level) > 1e-9 ? glm::normalize(level) : glm::dvec3(1, 0, 0);
    const glm::dvec3 v = glm::cross(normal, u);
    const double c = std::cos(given.roll * kDegree), s = std::sin(given.roll * kDegree);
    light.u = (u * c + v * s) * (given.width / 2);
    light.v = (v * c - u * s) * (given.height / 2);
    return light;
}

AreaLight sphere(const LightSettings& given) {
    AreaLight light;
    light.shape = AreaShape::sphere;
    light.name = given.name;
    light.position = vectorOf(given.position);
    light.radius = given.radius;
    light.radiance = emitted(given);
    return light;
}

void addLight(Scene& scene, const LightSettings& light) {
    switch (light.kind) {
        case LightKind::point: scene.lights.push_back(punctual(light, PunctualType::point)); break;
        case LightKind::spot: scene.lights.push_back(punctual(light, PunctualType::spot)); break;
        case LightKind::directional:
            scene.lights.push_back(punctual(light, PunctualType::directional));
            break;
        case LightKind::quad: scene.areaLights.push_back(quad(light)); break;
        case LightKind::sphere: scene.areaLights.push_back(sphere(light)); break;
    }
}

void scaleRadiance(Image& image, double scale) {
    if (scale == 1) return;
    constexpr double largest = std::numeric_limits<float>::max();
    for (size_t i = 0; i < image.rgbaFloat.size(); ++i)
        if (i % 4 != 3)
            image.rgbaFloat[i] = static_cast<float>(std::min(image.rgbaFloat[i] * scale, largest));
}

void setEnvironment(Scene& scene, const EnvironmentSettings& given) {
    switch (given.kind) {
        case EnvironmentKind::automatic:
        case EnvironmentKind::file: break;
        case EnvironmentKind::constant:
            scene.environment = constantEnvironment({given.color[0], given.color[1], given.color[2]});
            break;
        case EnvironmentKind::none: scene.environment = {}; break;
        case EnvironmentKind::sky:
            addSky(scene, given.sky, given.intensity, given.rotation * kDegree);
            break;
    }
    if (given.kind != EnvironmentKind::sky) scaleRadiance(scene.environment.image, given.intensity);
    scene.environment.rotation = given.rotation * kDegree;
    scene.environment.visible = given.visible;
    // Where a job asks for an environment or for none, that is what it gets.
    if (given.kind == EnvironmentKind::automatic) lightIfDark(scene);
}

}  // namespace

GltfOptions gltfOptionsOf(const JobSpec& job) {
    return {.variant = job.variant,
            .animation = job.motion.animation,
            .loop = job.motion.loop,
            .strict = job.strict,
            .levelsUp = levelsAbove(job.scene.entry),
            .microfacets = job.settings.microfacets,
            .fresnel = job.settings.fresnel,
            .lightUnits = job.settings.lightUnits,
            .materials = job.materials};
}

void addJobLights(Scene& scene, const JobSpec& job) {
    for (const LightSettings& light : job.lights) addLight(scene, light);
}

void setJobEnvironment(Scene& scene, const JobSpec& job, const std::filesystem::path& file) {
    const EnvironmentKind kind = job.environment.kind;
    const bool wantsFile = kind == EnvironmentKind::automatic || kind == EnvironmentKind::file;
    if (wantsFile && !file.empty()) loadEnvironment(scene, file, job.strict);
    setEnvironment(scene, job.environment);
}

void setJobFog(Scene& scene, const JobSpec& job) {
    const FogSettings& given = job.fog;
    const auto byChannel = [](const Color& c) { return glm::dvec3(c[0], c[1], c[2]); };
    scene.fog.extinction = byChannel(given.extinction);
    scene.fog.albedo = byChannel(given.albedo);
    scene.fog.anisotropy = given.anisotropy;
    if (given.min && given.max) scene.fog.box = Fog::Box{vectorOf(*given.min), vectorOf(*given.max)};
}

Scene loadJobScene(const std::filesystem::path& entry, const std::filesystem::path& environment,
                   const JobSpec& job) {
    Scene scene = GltfSource(entry, gltfOptionsOf(job)).take();
    addJobLights(scene, job);
    setJobEnvironment(scene, job, environment);
    setJobFog(scene, job);
    return scene;
}

}  // namespace tilefarm
