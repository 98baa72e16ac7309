#pragma once

// The one table of everything a job and the messages around it may say: names, ranges, meanings.
// Reader, writer and schema (json_reader.h) all go over it. For .cpp files only.

#include "shared/job/appearance_fields.h"
#include "shared/job/job.h"
#include "shared/job/json_reader.h"
#include "shared/job/lease.h"
#include "shared/job/lighting_fields.h"
#include "shared/job/medium_fields.h"
#include "shared/job/output_fields.h"
#include "shared/job/viewing_fields.h"

namespace tilefarm {

inline constexpr uint32_t kMostTilesPerFrame = 1u << 18;

template <typename Visitor>
void describe(Visitor& v, Is<SceneBundle> auto& scene) {
    v.files({"files", "relative path of each file of the scene -> its SHA-256", kRequired}, scene.files,
            {1, 10000});
    v.text({"entry", "path within files of the .gltf or .glb", kRequired}, scene.entry, {1, 1024});
    v.text({"environment",
            "path within files of a picture of all directions: .hdr, .exr, .png or .jpg; empty for none"},
           scene.environment, {0, 1024});
}

template <typename Visitor>
void describe(Visitor& v, Is<FrameSet> auto& frames) {
    v.integer({"first", "number of the first frame"}, frames.first, kAnyInt32);
    v.integer({"count", "how many frames"}, frames.count, {1, kMostFrames});
    v.integer({"step", "from one frame to the next"}, frames.step, {1, 1 << 30});
    v.text({"list",
            "frames and ranges instead, like 1,5,9 or 1-100x10,205; first and count then follow from it"},
           frames.list, {0, 100000});
}

template <typename Visitor>
void describe(Visitor& v, Is<ImageSpec> auto& image) {
    v.givenInteger(
        {"width", "pixels; else from the height by the camera's aspect; with neither the longer side is 640"},
        image.width, {1, 32768});
    v.givenInteger({"height", "pixels; else from the width likewise"}, image.height, {1, 32768});
    v.integer({"tileSize", "pixels; never changes the picture"}, image.tileSize, {8, 1024, 8});
}

inline constexpr std::array kLightSelectionChoices{
    Choice<LightSelection>{"tree", LightSelection::tree},
    Choice<LightSelection>{"power", LightSelection::power},
    Choice<LightSelection>{"uniform", LightSelection::uniform},
    Choice<LightSelection>{"all", LightSelection::all},
};
inline constexpr std::array kDirectLightChoices{
    Choice<DirectLight>{"mis", DirectLight::mis},
    Choice<DirectLight>{"lights", DirectLight::lights},
    Choice<DirectLight>{"bsdf", DirectLight::bsdf},
};

template <typename Visitor>
void describe(Visitor& v, Is<RenderSettings> auto& settings) {
    v.integer({"seed", "of the random numbers"}, settings.seed, kAnyUint32);
    v.choice({"integrator",
              "path: all light, unbiased; whitted: mirrors, refraction and hard shadows; "
              "raster: drawn, without shadows; ambient-occlusion; or "
              "a view of the first surface: albedo, normal, geometric-normal, depth, uv, material, object"},
             settings.integrator, kIntegratorChoices);
    v.number({"aoDistance", "m that ambient-occlusion reaches; 0: half the diagonal of the scene's box"},
             settings.aoDistance, {0, 1e9});
    v.integer(
        {"maxBounces", "scatterings after the camera ray, at surfaces and in fog; 0 shows emission only"},
        settings.maxBounces, {0, 1024});
    v.integer({"rouletteStart", "bounces before Russian roulette, which is unbiased at any value"},
              settings.rouletteStart, {0, 1024});
    v.choice(
        {"roulette",
         "which paths it ends: those that carry little (throughput), all alike (constant) or none; no rule "
         "is biased"},
        settings.roulette, kRouletteChoices);
    v.number({"rouletteSurvival", "probability of going on, of the constant rule"}, settings.rouletteSurvival,
             {0.05, 1});
    v.integer({"shadowDepth",
               "bounces after which shadow rays are skipped; biased below maxBounces: the "
               "picture is too bright"},
              settings.shadowDepth, {0, 1024});
    v.choice({"directionSampling",
              "how a path's next direction is drawn: by what the surface scatters (bsdf), by the cosine, or "
              "uniform over the sphere; none is biased"},
             settings.directionSampling, kDirectionSamplingChoices);
    v.number(
        {"clampDirect",
         "W/(sr m²): bound of the largest channel of light that scattered once; 0 for none, else biased"},
        settings.clampDirect, {0, 1e30});
    v.number({"clampIndirect", "likewise of light that scattered more than once"}, settings.clampIndirect,
             {0, 1e30});
    v.number({"regularisation",
              "least microfacet α of surfaces that a path meets behind a rough one; 0 for none, else biased: "
              "caustics blur"},
             settings.regularisation, {0, 1});
    v.choice({"lightSelection",
              "which light a surface point asks: one by its estimated share there (tree), "
              "one by power, one of all alike (uniform), or every one (all)"},
             settings.lightSelection, kLightSelectionChoices);
    v.choice({"directLight",
              "direct light by sampling lights and BSDF, weighted (mis), or by one of them alone; "
              "bsdf alone never finds lights without extent"},
             settings.directLight, kDirectLightChoices);
    v.choice({"microfacets", "distribution of normals of materials that do not say theirs"},
             settings.microfacets, kMicrofacetChoices);
    v.choice({"fresnel", "of dielectrics that do not say theirs; schlick is an approximation"},
             settings.fresnel, kFresnelChoices);
    v.flag({"energyCompensation", "light that scatters more than once between microfacets"},
           settings.energyCompensation);
    v.choice({"filter", "how samples are spread over a pixel: box, tent, gaussian or blackmanHarris"},
             settings.filter, kPixelFilterChoices);
    v.number({"filterRadius", "pixels; 0: the usual one (0.5 box, 1 tent, 1.5 gaussian and blackmanHarris)"},
             settings.filterRadius, {0, 16});
    v.flag({"jitter", "samples are spread over the pixel; else all go through its centre, which aliases"},
           settings.jitter);
    v.choice({"sampler",
              "where the random numbers come from: independent (random), jittered grids (stratified) or "
              "Owen-scrambled Sobol points (sobol); none is biased"},
             settings.sampler, kSamplerChoices);
    v.integer({"strata", "per side of the stratified sampler's grids; best with strata² samples"},
              settings.strata, {1, 4096});
    v.choice(
        {"cameraFit",
         "how the view of the file's camera lies in a picture of another aspect: by its height (vertical), "
         "its width (horizontal), so that all of it is seen (fit) or nothing beyond it (fill)"},
        settings.cameraFit, kCameraFitChoices);
    v.flag({"cameraClip", "the camera sees between the znear and zfar of the file's camera alone"},
           settings.cameraClip);
    v.choice(
        {"culling",
         "which rays pass through the back faces of materials that are not double-sided: none, those from "
         "the camera to the first surface, or all; no value is biased, each is another scene"},
        settings.culling, kCullingChoices);
    v.choice(
        {"lightUnits",
         "of the file's KHR_lights_punctual: W/sr and W/m² (radiometric), or candela and lux, divided by "
         "683 lm/W (photometric)"},
        settings.lightUnits, kLightUnitsChoices);
}

template <typename Visitor>
void describe(Visitor& v, Is<StopCondition> auto& stop) {
    v.integer({"samples", "per pixel"}, stop.samples, {1, 1 << 24});
}

template <typename Visitor>
void describe(Visitor& v, Is<JobSpec> auto& job) {
    v.text({"name", "for people"}, job.name, {0, 200});
    v.object({"scene", "", kRequired}, job.scene);
    v.text(
        {"camera", "a camera or its node by name; auto: the scene's first, else one that frames the scene"},
        job.camera, {1, 1024});
    v.object({"frames", ""}, job.frames);
    v.object({"image", ""}, job.image);
    v.object({"settings", ""}, job.settings);
    v.object({"environment", "what surrounds the scene"}, job.environment);
    v.list({"lights", "added to the scene's"}, job.lights, {0, 10000});
    v.object({"fog", "a homogeneous medium between the surfaces"}, job.fog);
    v.list({"materials", "what to change of materials; later ones win"}, job.materials, {0, 10000});
    v.text({"variant", "of KHR_materials_variants by name; empty for the file's default materials"},
           job.variant, {0, 1024});
    v.flag(
        {"strict",
         "fail where the scene is not valid glTF or what it does not need is broken, instead of a warning"},
        job.strict);
    v.object({"view", "a camera that the job places, and the lens of any"}, job.view);
    v.object({"motion", "time, animation, turntable and motion blur"}, job.motion);
    v.object({"output", "what the EXR holds beyond the picture; none of it changes the picture"}, job.output);
    v.object({"stop", "when the picture is done"}, job.stop);
    v.integer({"priority", "higher goes first"}, job.priority, {0, 100});
}

template <typename Visitor>
void describe(Visitor& v, Is<LeasedPass> auto& pass) {
    v.integer({"tile", "index in the frame's tiles, row by row", kRequired}, pass.tile,
              {0, kMostTilesPerFrame - 1});
    v.integer({"first", "first sample index", kRequired}, pass.samples.first, {0, 1 << 24});
    v.integer({"count", "samples", kRequired}, pass.samples.count, {1, kMaxPassSamples});
}

template <typename Visitor>
void describe(Visitor& v, Is<Lease> auto& lease) {
    v.text({"id", "", kRequired}, lease.id, {1, 64});
    v.integer({"epoch", "grows with every grant", kRequired}, lease.epoch,
              {0, std::numeric_limits<int64_t>::max()});
    v.text({"jobId", "", kRequired}, lease.jobId, {1, 64});
    v.object({"spec", "", kRequired}, lease.spec);
    v.integer({"frame", "", kRequired}, lease.frame, kAnyInt32);
    v.list({"passes", "by first sample, then tile", kRequired}, lease.passes, {1, 1 << 20});
    v.integer({"expiresInMs", "from the answer", kRequired}, lease.expiresInMs, kAnyUint32);
    v.integer({"renewEveryMs", "", kRequired}, lease.renewEveryMs, kAnyUint32);
}

template <typename Visitor>
void describe(Visitor& v, Is<WorkerHello> auto& hello) {
    v.text({"worker", "stable id, unique per process and device", kRequired}, hello.worker, {1, 200});
    v.text({"host", "for people"}, hello.host, {0, 255});
    v.text({"device", "Vulkan device name"}, hello.device, {0, 256});
    v.text({"driver", "driver name and version"}, hello.driver, {0, 512});
    v.text({"version", "of Tilefarm", kRequired}, hello.version, {1, 64});
    v.text({"session", "the worker's process, the same for all of its devices"}, hello.session, {0, 200});
    v.texts({"ended", "sessions on this machine that were killed or crashed"}, hello.ended, {0, 100},
            {1, 200});
}

template <typename Visitor>
void describe(Visitor& v, Is<ResultReceipt> auto& receipt) {
    v.integer({"merged", "passes counted now", kRequired}, receipt.merged, kAnyUint32);
    v.integer({"alreadyMerged", "passes counted before", kRequired}, receipt.alreadyMerged, kAnyUint32);
}

}  // namespace tilefarm
