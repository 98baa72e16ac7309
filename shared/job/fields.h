#pragma once

// The one table of the members of a job and of the messages around it: names, ranges, meanings.
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
    v.files({"files", "the scene's files: relative path -> SHA-256 of an uploaded blob", kRequired},
            scene.files, {1, 10000});
    v.text({"entry", "which of files is the .gltf or .glb to render", kRequired}, scene.entry, {1, 1024});
    v.text({"environment",
            "which of files is the environment map: .hdr, .exr, .png or .jpg, equirectangular or an .exr "
            "cube map; empty for none"},
           scene.environment, {0, 1024});
}

template <typename Visitor>
void describe(Visitor& v, Is<FrameSet> auto& frames) {
    v.integer({"first", "number of the first frame"}, frames.first, kAnyInt32);
    v.integer({"count", "how many frames"}, frames.count, {1, kMostFrames});
    v.integer({"step", "difference between the numbers of successive frames"}, frames.step, {1, 1 << 30});
    v.text({"list", "frame numbers and ranges in place of first, count and step, e.g. 1,5,9 or 1-100x10,205"},
           frames.list, {0, 100000});
}

template <typename Visitor>
void describe(Visitor& v, Is<ImageSpec> auto& image) {
    v.givenInteger({"width",
                    "width, pixels; if not given, computed from the height and the camera's aspect ratio; "
                    "with neither given, the longer side is 640"},
                   image.width, {1, 32768});
    v.givenInteger(
        {"height", "height, pixels; if not given, computed from the width and the camera's aspect ratio"},
        image.height, {1, 32768});
    v.integer({"tileSize",
               "side of the square tiles that workers render, pixels; the picture is the same for any size, "
               "but for stop.relativeError, which decides tile by tile"},
              image.tileSize, {8, 1024, 8});
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
    v.integer({"seed", "seed of the random numbers: another seed gives the same picture with other noise"},
              settings.seed, kAnyUint32);
    v.choice(
        {"integrator",
         "path: path tracing, all light transport, unbiased; whitted: Whitted ray tracing, with mirrors, "
         "refraction and hard shadows; raster: rasterization, without shadows; ambient-occlusion; or one "
         "property of the first surface: albedo, normal, geometric-normal, depth, uv, material, object"},
        settings.integrator, kIntegratorChoices);
    v.number({"aoDistance",
              "length of the ambient-occlusion rays, m; 0: half the diagonal of the scene's bounding box"},
             settings.aoDistance, {0, 1e9});
    v.integer({"maxBounces",
               "most scattering events of a path after the camera ray, at surfaces and in fog; 0 shows "
               "emission only"},
              settings.maxBounces, {0, 1024});
    v.integer({"rouletteStart", "bounces before Russian roulette may end a path; unbiased at any value"},
              settings.rouletteStart, {0, 1024});
    v.choice({"roulette",
              "probability that a path survives Russian roulette: its throughput (throughput), "
              "rouletteSurvival for all paths (constant), or always (none); unbiased in each case"},
             settings.roulette, kRouletteChoices);
    v.number({"rouletteSurvival", "survival probability of roulette = constant"}, settings.rouletteSurvival,
             {0.05, 1});
    v.integer(
        {"shadowDepth",
         "bounces after which shadow rays are skipped; biased below maxBounces: the picture is too bright"},
        settings.shadowDepth, {0, 1024});
    v.choice({"directionSampling",
              "how a path's next direction is sampled: from the BSDF (bsdf), cosine-weighted (cosine), or "
              "uniformly over the sphere (uniform); unbiased in each case"},
             settings.directionSampling, kDirectionSamplingChoices);
    v.number({"clampDirect",
              "clamps direct light: upper limit of the largest channel of one sample's contribution, W/(sr "
              "m²); 0: no clamping; biased otherwise"},
             settings.clampDirect, {0, 1e30});
    v.number({"clampIndirect",
              "clamps indirect light (two bounces or more): upper limit of the largest channel of one "
              "sample's contribution, W/(sr m²); 0: no clamping; biased otherwise"},
             settings.clampIndirect, {0, 1e30});
    v.number({"regularisation",
              "path regularization: smallest microfacet α used after a rough bounce, so that caustics "
              "converge faster but blur; 0: none; biased otherwise"},
             settings.regularisation, {0, 1});
    v.choice({"lightSelection",
              "which lights a shading point samples: one chosen by its estimated contribution there (tree), "
              "one chosen by power (power), one chosen uniformly (uniform), or every light (all)"},
             settings.lightSelection, kLightSelectionChoices);
    v.choice(
        {"directLight",
         "direct light by multiple importance sampling of lights and BSDF (mis), by light sampling alone "
         "(lights) or by BSDF sampling alone (bsdf); bsdf misses point, spot and directional lights"},
        settings.directLight, kDirectLightChoices);
    v.choice({"microfacets", "normal distribution function of materials that do not name one"},
             settings.microfacets, kMicrofacetChoices);
    v.choice({"fresnel",
              "Fresnel reflectance of dielectrics that do not name one; schlick is Schlick's approximation"},
             settings.fresnel, kFresnelChoices);
    v.flag({"energyCompensation",
            "adds the light that scatters several times between microfacets; without it rough surfaces are "
            "too dark"},
           settings.energyCompensation);
    v.choice({"filter",
              "pixel reconstruction filter, sampled by importance: box, tent, gaussian or blackmanHarris"},
             settings.filter, kPixelFilterChoices);
    v.number({"filterRadius",
              "radius of the pixel filter, pixels; 0: its default (box 0.5, tent 1, gaussian and "
              "blackmanHarris 1.5)"},
             settings.filterRadius, {0, 16});
    v.flag({"jitter",
            "samples are distributed over the pixel filter; off: all go through the pixel's centre, which "
            "aliases"},
           settings.jitter);
    v.choice({"sampler",
              "sample sequence: independent random numbers (random), jittered grids (stratified) or "
              "Owen-scrambled Sobol points (sobol); unbiased in each case"},
             settings.sampler, kSamplerChoices);
    v.integer(
        {"strata", "cells per side of the stratified sampler's grids; best with strata² samples per pixel"},
        settings.strata, {1, 4096});
    v.choice({"cameraFit",
              "how the field of view of the file's camera is adapted to a picture of another aspect ratio: "
              "keep its height (vertical) or its width (horizontal), show all of it (fit), or show nothing "
              "beyond it (fill)"},
             settings.cameraFit, kCameraFitChoices);
    v.flag({"cameraClip", "camera rays see only what lies between znear and zfar of the file's camera"},
           settings.cameraClip);
    v.choice({"culling",
              "back-face culling of materials that are not double-sided: for no rays (none), for camera rays "
              "up to the first surface (camera), or for all rays (all)"},
             settings.culling, kCullingChoices);
    v.choice({"lightUnits",
              "how intensities of the file's KHR_lights_punctual are read: as W/sr and W/m² (radiometric), "
              "or as candela and lux, divided by 683 lm/W (photometric)"},
             settings.lightUnits, kLightUnitsChoices);
}

template <typename Visitor>
void describe(Visitor& v, Is<StopCondition> auto& stop) {
    v.givenInteger({"samples",
                    "most samples per pixel; if not given, 64, or 65536 where there is an error target or a "
                    "time limit"},
                   stop.samples, {1, 1 << 24});
    v.number({"relativeError",
              "error target: a frame is complete once its estimated relative error is no larger, and samples "
              "go to the tiles that hold the error; 0: none. The same job gives the same picture"},
             stop.relativeError, {0, 1e6});
    v.integer({"minSamples", "samples per pixel that come before the first look at the error target"},
              stop.minSamples, {1, 1 << 24});
    v.number({"deviceSeconds",
              "time limit: device seconds of a frame, of all workers together; 0: none. How many samples fit "
              "in differs from run to run"},
             stop.deviceSeconds, {0, 1e9});
    v.number(
        {"wallSeconds",
         "time limit: seconds since a frame was begun; 0: none. How many samples fit in differs from run "
         "to run"},
        stop.wallSeconds, {0, 1e9});
}

template <typename Visitor>
void describe(Visitor& v, Is<JobSpec> auto& job) {
    v.text({"name", "shown in lists; has no effect"}, job.name, {0, 200});
    v.object({"scene", "the scene's files", kRequired}, job.scene);
    v.text({"camera",
            "name of a camera of the file, or of its node; auto: the file's first camera, or one that frames "
            "the scene if the file has none"},
           job.camera, {1, 1024});
    v.object({"frames", "which frames to render"}, job.frames);
    v.object({"image", "size of the picture"}, job.image);
    v.object({"settings", "integrator, sampling and what trades accuracy for time"}, job.settings);
    v.object({"environment", "light from all directions around the scene"}, job.environment);
    v.list({"lights", "lights added to those of the file"}, job.lights, {0, 10000});
    v.object({"fog", "a homogeneous participating medium"}, job.fog);
    v.list({"materials", "overrides of the file's materials; later ones win"}, job.materials, {0, 10000});
    v.text({"variant", "name of a variant of KHR_materials_variants; empty: the file's default materials"},
           job.variant, {0, 1024});
    v.flag({"strict",
            "fail on invalid glTF and on broken parts that the picture does not need, instead of warning"},
           job.strict);
    v.object({"view", "a camera placed by the job in place of the file's, and the lens of either"}, job.view);
    v.object({"motion", "frame rate, animation, turntable and motion blur"}, job.motion);
    v.object({"output", "additional channels (AOVs) of the EXR; the picture stays the same"}, job.output);
    v.object({"stop", "when a frame is complete"}, job.stop);
    v.integer({"priority", "jobs of higher priority are rendered first"}, job.priority, {0, 100});
}

template <typename Visitor>
void describe(Visitor& v, Is<LeasedPass> auto& pass) {
    v.integer({"tile", "index of the tile, row by row from the top left", kRequired}, pass.tile,
              {0, kMostTilesPerFrame - 1});
    v.integer({"first", "index of the pass's first sample per pixel", kRequired}, pass.samples.first,
              {0, 1 << 24});
    v.integer({"count", "samples per pixel", kRequired}, pass.samples.count, {1, kMaxPassSamples});
}

template <typename Visitor>
void describe(Visitor& v, Is<Lease> auto& lease) {
    v.text({"id", "names the lease in requests below /v1/leases", kRequired}, lease.id, {1, 64});
    v.integer({"epoch", "fencing number: larger for every lease granted; to be sent back with the result",
               kRequired},
              lease.epoch, {0, std::numeric_limits<int64_t>::max()});
    v.text({"jobId", "the job that the passes belong to", kRequired}, lease.jobId, {1, 64});
    v.object({"spec", "the job as it was submitted", kRequired}, lease.spec);
    v.integer({"frame", "number of the frame that the passes belong to", kRequired}, lease.frame, kAnyInt32);
    v.list({"passes", "what to render, ordered by first sample, then tile", kRequired}, lease.passes,
           {1, 1 << 20});
    v.integer({"expiresInMs", "ms from this answer until the lease expires unless it is renewed", kRequired},
              lease.expiresInMs, kAnyUint32);
    v.integer({"renewEveryMs", "ms between renewals", kRequired}, lease.renewEveryMs, kAnyUint32);
}

template <typename Visitor>
void describe(Visitor& v, Is<WorkerHello> auto& hello) {
    v.text({"worker", "id of the worker, unique per process and device", kRequired}, hello.worker, {1, 200});
    v.text({"host", "name of the machine; shown in lists"}, hello.host, {0, 255});
    v.text({"device", "name of the Vulkan device"}, hello.device, {0, 256});
    v.text({"driver", "name and version of the Vulkan driver"}, hello.driver, {0, 512});
    v.text({"version", "Tilefarm version of the worker; must be the server's", kRequired}, hello.version,
           {1, 64});
    v.text({"session", "id of the worker process, shared by all of its devices"}, hello.session, {0, 200});
    v.texts({"ended", "ids of earlier worker processes on this machine that were killed or crashed"},
            hello.ended, {0, 100}, {1, 200});
}

template <typename Visitor>
void describe(Visitor& v, Is<ResultReceipt> auto& receipt) {
    v.integer({"merged", "passes of this result that were merged into the picture", kRequired},
              receipt.merged, kAnyUint32);
    v.integer({"alreadyMerged", "passes of this result that had been merged before", kRequired},
              receipt.alreadyMerged, kAnyUint32);
}

}  // namespace tilefarm
