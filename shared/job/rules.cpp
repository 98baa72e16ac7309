#include "shared/job/rules.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "shared/job/fields.h"
#include "shared/job/pass_schedule.h"
#include "shared/job/safe_path.h"

namespace tilefarm {

namespace {

void checkScenePath(const SceneBundle& scene, const std::string& path, const std::string& pointer,
                    const std::vector<const char*>& suffixes, Faults& faults) {
    if (path.empty() || faults.at(pointer)) return;
    if (std::none_of(suffixes.begin(), suffixes.end(), [&](auto suffix) { return hasSuffix(path, suffix); }))
        faults.add(pointer, fmt::format("must end with {}", fmt::join(suffixes, " or ")));
    if (!scene.files.empty() && !scene.files.contains(path))
        faults.add(pointer, "names '" + path + "', which is not among /scene/files");
}

void checkFrames(const FrameSet& frames, Faults& faults) {
    if (!frames.list.empty()) return;
    const int64_t last = frames.first + (int64_t{frames.count} - 1) * frames.step;
    if (!faults.at("/frames") && last > std::numeric_limits<int32_t>::max())
        faults.add("/frames/count", fmt::format("makes the last frame {}, above {}", last,
                                                std::numeric_limits<int32_t>::max()));
}

void checkTiles(const ImageSpec& image, Faults& faults) {
    if (faults.at("/image")) return;
    if (const uint32_t tiles = TileGrid(image).count(); tiles > kMostTilesPerFrame)
        faults.add("/image/tileSize", fmt::format("cuts {}x{} pixels into {} tiles, more than {}",
                                                  image.width, image.height, tiles, kMostTilesPerFrame));
}

void checkEnvironment(const JobSpec& job, Faults& faults) {
    const EnvironmentSettings& e = job.environment;
    if (faults.at("/environment")) return;
    if (e.kind == EnvironmentKind::file && job.scene.environment.empty())
        faults.add("/environment/kind", "is file, but the scene has no environment file");
    if (e.kind != EnvironmentKind::constant && e.color != EnvironmentSettings{}.color)
        faults.add("/environment/color", "applies to environment.kind constant only");
    if (e.kind != EnvironmentKind::sky && e.sky != SkySettings{})
        faults.add("/environment/sky", "applies to environment.kind sky only");
}

// A member that says something of another kind of light is a mistake that would pass in silence.
void checkLightMembers(const LightSettings& light, const std::string& pointer, Faults& faults) {
    using K = LightKind;
    const LightSettings usual;
    const auto belongs = [&](const char* member, bool isUsual, std::initializer_list<K> kinds) {
        if (!isUsual && std::find(kinds.begin(), kinds.end(), light.kind) == kinds.end())
            faults.add(pointer + "/" + member, "does not apply to lights of this kind");
    };
    belongs("position", light.position == usual.position, {K::point, K::spot, K::quad, K::sphere});
    belongs("direction", light.direction == usual.direction, {K::spot, K::directional, K::quad});
    belongs("innerCone", light.innerCone == usual.innerCone, {K::spot});
    belongs("outerCone", light.outerCone == usual.outerCone, {K::spot});
    belongs("angularDiameter", light.angularDiameter == usual.angularDiameter, {K::directional});
    belongs("width", light.width == usual.width, {K::quad});
    belongs("height", light.height == usual.height, {K::quad});
    belongs("roll", light.roll == usual.roll, {K::quad});
    belongs("twoSided", light.twoSided == usual.twoSided, {K::quad});
    belongs("radius", light.radius == usual.radius, {K::sphere});
}

void checkLight(const LightSettings& light, const std::string& pointer, Faults& faults) {
    if (faults.at(pointer)) return;
    checkLightMembers(light, pointer, faults);
    if (light.direction == std::array<double, 3>{0, 0, 0})
        faults.add(pointer + "/direction", "must not be zero");
    if (light.innerCone > light.outerCone)
        faults.add(pointer + "/innerCone",
                   fmt::format("is {}, wider than the outer cone of {}", light.innerCone, light.outerCone));
}

bool isZero(const std::array<double, 3>& v) {
    return v == std::array<double, 3>{0, 0, 0};
}

void checkView(const ViewSettings& view, Faults& faults) {
    if (faults.at("/view")) return;
    if (view.kind == ViewKind::scene &&
        (view.eye != ViewSettings{}.eye || view.target != ViewSettings{}.target))
        faults.add("/view/kind",
                   "must be perspective, orthographic or panorama where eye or target is given");
    if (view.eye == view.target) faults.add("/view/target", "must differ from eye");
    if (isZero(view.up)) faults.add("/view/up", "must not be zero");
    if (view.apertureRadius > 0 && view.fNumber > 0)
        faults.add("/view/fNumber", "cannot be combined with apertureRadius: both give the size of the lens");
    const bool flat = view.kind == ViewKind::orthographic || view.kind == ViewKind::panorama;
    if (flat && (view.apertureRadius > 0 || view.fNumber > 0))
        faults.add(view.fNumber > 0 ? "/view/fNumber" : "/view/apertureRadius",
                   "applies to perspective cameras only");
    if (view.blades == 1 || view.blades == 2) faults.add("/view/blades", "must be 0 or at least 3");
}

void checkIntegrator(const JobSpec& job, Faults& faults) {
    if (faults.at("/settings") || faults.at("/view")) return;
    if (job.settings.integrator == Integrator::raster && job.view.kind == ViewKind::panorama)
        faults.add("/settings/integrator",
                   "raster cannot render panoramas: rasterization keeps straight lines straight");
}

void checkMotion(const MotionSettings& motion, Faults& faults) {
    if (!faults.at("/motion") && !std::has_single_bit(motion.shutterSteps))
        faults.add("/motion/shutterSteps", "must be a power of two");
}

void checkFog(const FogSettings& fog, Faults& faults) {
    if (faults.at("/fog")) return;
    if (fog.min.has_value() != fog.max.has_value())
        faults.add(fog.min ? "/fog/max" : "/fog/min", "is missing: a box needs both corners");
    if (!fog.min || !fog.max) return;
    for (size_t axis = 0; axis < 3; ++axis)
        if (!((*fog.min)[axis] < (*fog.max)[axis]))
            faults.add(fmt::format("/fog/max/{}", axis),
                       fmt::format("is {}, not above min's {}", (*fog.max)[axis], (*fog.min)[axis]));
}

void checkOutput(const JobSpec& job, Faults& faults) {
    if (job.output.lightPaths && job.settings.integrator != Integrator::path)
        faults.add("/output/lightPaths", "applies to settings.integrator path only");
}

}  // namespace

void checkAppearance(const MaterialOverride& material, const std::string& pointer, Faults& faults) {
    if (material.clearcoatGloss && material.clearcoatRoughness && !faults.at(pointer))
        faults.add(pointer + "/clearcoatGloss",
                   "cannot be combined with clearcoatRoughness: both give the width of the highlight");
}

void settleFrames(FrameSet& frames, Faults& faults) {
    if (frames.list.empty() || faults.at("/frames")) return;
    FrameSet listed;
    try {
        listed = framesFrom(frames.list);
    } catch (const Error& error) {
        return faults.add("/frames/list", error.what());
    }
    const auto check = [&](const char* member, int64_t given, int64_t usual, int64_t follows) {
        if (given != usual && given != follows)
            faults.add(std::string("/frames/") + member,
                       fmt::format("is {}, but the list makes it {}", given, follows));
    };
    const FrameSet usual;
    check("first", frames.first, usual.first, listed.first);
    check("count", frames.count, usual.count, listed.count);
    check("step", frames.step, usual.step, listed.step);
    frames = listed;
}

void settleStop(StopCondition& stop, Faults& faults) {
    if (stop.samples != 0 || faults.at("/stop")) return;
    stop.samples = stop.decidesOnTheWay() ? kUsualMostSamples : kUsualSamples;
}

void checkJob(const JobSpec& job, Faults& faults) {
    checkScenePath(job.scene, job.scene.entry, "/scene/entry", {".gltf", ".glb"}, faults);
    checkScenePath(job.scene, job.scene.environment, "/scene/environment",
                   {".hdr", ".exr", ".png", ".jpg", ".jpeg"}, faults);
    checkFrames(job.frames, faults);
    checkTiles(job.image, faults);
    checkEnvironment(job, faults);
    checkFog(job.fog, faults);
    checkView(job.view, faults);
    checkMotion(job.motion, faults);
    checkIntegrator(job, faults);
    checkOutput(job, faults);
    for (size_t i = 0; i < job.lights.size(); ++i)
        checkLight(job.lights[i], fmt::format("/lights/{}", i), faults);
    for (size_t i = 0; i < job.materials.size(); ++i)
        checkAppearance(job.materials[i], fmt::format("/materials/{}", i), faults);
}

}  // namespace tilefarm
