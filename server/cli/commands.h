#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/cli/console.h"
#include "shared/farm_client/farm_client.h"
#include "shared/image/tone.h"
#include "shared/job/job.h"
#include "shared/job/numbered.h"

namespace tilefarm {

/// Every command gives an exit code and throws Error, which cli.cpp turns into a message and a code.

struct PictureOptions {
    std::filesystem::path exr, png;  // empty: not wanted
    ToneMapping tone;                // of the PNG
    bool denoised = false;           // the PNG shows the picture without its noise
};

// ---- submit.cpp

struct SubmitOptions {
    JobSpec spec;  // all but the scene's files
    std::filesystem::path scene, environment;
    bool wait = false;
    bool dryRun = false;  // a pilot alone, and what the job would take
    PictureOptions pictures;  // wanted ones make it wait
};

/// The job with its scene, whose files are on the server then.
JobSpec uploadScene(FarmClient& farm, const SubmitOptions& options, const Console& console);
/// Hashes the scene's files, uploads those the server lacks, makes the job and prints its id; waits
/// for its end and downloads the pictures if asked to.
int submit(FarmClient& farm, const SubmitOptions& options, const Console& console);
/// Follows a job with a progress line until it ends; rides out a server that restarts.
int waitForJob(FarmClient& farm, const std::string& id, const Console& console);

// ---- study.cpp

struct StudyOptions {
    SubmitOptions base;
    std::vector<std::string> knobs;  // "settings.clampIndirect=1,10"; a list in brackets is JSON
    std::vector<uint32_t> samples;
    uint32_t seeds = 5, referenceSamples = 0;  // 0: the server's usual
    int32_t priority = 10;
    bool grid = false, wait = false;
    std::vector<std::filesystem::path> reports;  // .html, .csv or .json; wanted ones make it wait
};

/// Uploads the scene, submits a study of it and prints its id.
int submitStudy(FarmClient& farm, const StudyOptions& options, const Console& console);
int showStudies(FarmClient& farm, bool json, const Console& console);
/// Prints what a study found so far, its verdict first, and downloads the reports.
int showStudy(FarmClient& farm, const std::string& id, bool wait,
              const std::vector<std::filesystem::path>& reports, const Console& console);
int cancelStudy(FarmClient& farm, const std::string& id, const Console& console);

// ---- download.cpp

/// Downloads the pictures of one frame, and what manifests the EXR names, beside it.
void downloadFrame(FarmClient& farm, const std::string& id, int32_t frame, const PictureOptions& pictures,
                   const Console& console);
/// By default the job's first frame.
int download(FarmClient& farm, const std::string& id, std::optional<int32_t> frame,
             const PictureOptions& pictures, const Console& console);

// ---- frames.cpp

/// Those of a job's spec.
FrameSet framesOf(const nlohmann::json& spec);
/// The pictures of several frames, "all" or as framesFrom reads them: numbered files, or a .zip of EXRs. PNGs
/// look as `like` says.
int downloadFrames(FarmClient& farm, const std::string& id, const std::string& which,
                   const std::filesystem::path& output, const PictureOptions& like, const Console& console);
/// All frames as a movie, from the lowest number on, by ffmpeg; what kind, the file's suffix says. `fps` 0:
/// the job's own.
int makeMovie(FarmClient& farm, const std::string& id, const std::filesystem::path& output, double fps,
              const PictureOptions& like, const Console& console);

// ---- show.cpp

int showJobs(FarmClient& farm, const std::string& state, bool json, const Console& console);
int showJob(FarmClient& farm, const std::string& id, bool json, const Console& console);
int showWorkers(FarmClient& farm, bool json, const Console& console);
/// A table of error targets and what they would take. `path`: of the forecast, as the API gives it.
int showForecast(FarmClient& farm, const std::string& path, bool json, const Console& console);
enum class Move { cancel, pause, resume };
int moveJob(FarmClient& farm, const std::string& id, Move move, const Console& console);

// ---- compare.cpp

struct CompareOptions {
    std::filesystem::path a, b;
    bool json = false;
    bool identical = false;           // fail unless every channel has the same bits
    std::optional<double> maxRelMse;  // fail above
    ToneMapping tone;                 // of what FLIP's viewer sees
};
/// Measures a against b by all of imageMetrics().
int compare(const CompareOptions& options, const Console& console);

/// Shows an EXR as a PNG: its picture, or a layer ("albedo", "normal", "variance") or channel ("Z").
int convertToPng(const std::filesystem::path& exr, const std::filesystem::path& png,
                 const std::string& channel, const ToneMapping& tone, const Console& console);

// ---- denoise.cpp

/// Adds the picture without its noise to a frame's EXR. Left and right edge meet if `wrap` or if the file
/// says that it is a panorama.
int denoiseFile(const std::filesystem::path& in, const std::filesystem::path& out, bool wrap,
                const Console& console);

}  // namespace tilefarm
