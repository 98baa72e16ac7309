#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "shared/image/tone.h"
#include "worker/local/frame_render.h"

namespace tilefarm {

/// What `tilefarm-worker render` is asked for.
struct LocalRender {
    SceneFiles files;
    JobSpec spec;  // without its scene, which comes from `files`
    std::filesystem::path exr;
    std::filesystem::path png, report;  // empty: not wanted
    ToneMapping tone;
    std::optional<DroppedSample> pixel;  // show this sample alone, step by step, and render nothing else
};

/// Throws Error(invalidArgument) with every fault of the options, named as in a job's JSON.
void requireValid(const LocalRender& render);

/// Renders a scene from this disk into files. Outputs are checked to be writable before the work.
/// With `pixel`, the sample's radiance and steps go to `samples`, and the device has to trace (FEATURE_TRACE).
/// `progress` gets a line that is written over if it is a terminal, else a line for every level.
void runLocalRender(const LocalRender& render, const std::function<std::unique_ptr<RenderBackend>()>& backend,
                    const Clock& clock, std::FILE* progress, std::FILE* samples = stdout);

}  // namespace tilefarm
