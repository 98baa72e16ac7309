#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "server/cli/commands.h"
#include "server/cli/progress.h"
#include "server/cli/scene_bundle.h"
#include "shared/error/error.h"
#include "shared/file/durable_file.h"
#include "shared/gltf/picture_size.h"
#include "shared/job/states.h"
#include "shared/job/wire.h"

namespace tilefarm {

namespace {

using nlohmann::json;

constexpr Milliseconds kPollInterval{500};
constexpr Milliseconds kServerMayBeAway{120'000};

void uploadMissing(FarmClient& farm, const BundledScene& scene, const Console& console) {
    std::vector<std::string> digests;
    for (const auto& [digest, file] : scene.blobs) digests.push_back(digest);
    const std::vector<std::string> missing = farm.missingBlobs(digests);
    for (size_t i = 0; i < missing.size(); ++i) {
        const auto blob = scene.blobs.find(missing[i]);
        if (blob == scene.blobs.end())
            throw Error(ErrorCode::internal, "the server asks for a blob that is not of this scene");
        const auto megabytes = static_cast<double>(std::filesystem::file_size(blob->second)) / 1e6;
        console.err << fmt::format("uploading {} of {}: {} ({:.1f} MB)\n", i + 1, missing.size(),
                                   blob->second.filename().string(), megabytes)
                    << std::flush;
        farm.putBlob(blob->first, blob->second);
    }
}

JobProgress progressOf(const json& view) {
    JobProgress p;
    p.state = view.at("state");
    p.fraction = view.at("progress").at("fraction");
    p.samples = view.at("samplesMerged");
    p.samplesWanted = view.at("spec").at("stop").at("samples");
    p.errorWanted = view.at("spec").at("stop").value("relativeError", 0.0);
    p.frames = view.at("spec").at("frames").at("count");
    p.framesDone = view.value("framesDone", 0u);
    if (const auto error = view.find("relativeError"); error != view.end() && error->is_number())
        p.relativeError = error->get<double>();
    return p;
}

// It may go on, but not before somebody has looked at it.
bool isSetAside(const json& view) {
    const auto reason = view.find("setAside");
    return reason != view.end() && reason->is_string();
}

int reportEnd(const json& view, const Console& console) {
    const std::string state = view.at("state");
    for (const json& notice : view.value("notices", json::array()))
        console.err << "note: " << notice.get<std::string>() << '\n';
    if (const json stopped = view.value("stopped", json()); state == "completed" && stopped.is_string())
        console.err << stopped.get<std::string>() << '\n';
    if (state == "completed") return kDone;
    console.err << fmt::format("the job is {}\n", isSetAside(view) ? "set aside" : state);
    for (const json& fault : view.value("faults", json::array()))
        console.err << "  " << (fault.is_string() ? fault.get<std::string>() : fault.dump()) << '\n';
    return kFailed;
}

}  // namespace

int waitForJob(FarmClient& farm, const std::string& id, const Console& console) {
    json view;
    {
        ProgressLine line(console);
        TimePoint heard = console.clock.now();
        bool away = false;
        while (true) {
            try {
                view = farm.job(id);
                heard = console.clock.now();
                away = false;
                line.show(progressOf(view));
                if (isFinal(jobStateFrom(view.at("state").get<std::string>())) || isSetAside(view)) break;
            } catch (const Error& e) {
                if (e.code != ErrorCode::unavailable || console.clock.now() - heard > kServerMayBeAway) throw;
                if (!std::exchange(away, true)) line.note(fmt::format("{}; trying again", e.what()));
            }
            console.sleep(kPollInterval);
        }
    }
    return reportEnd(view, console);
}

namespace {

int forecastJob(FarmClient& farm, const JobSpec& spec, const Console& console) {
    const json started = farm.startForecast(spec);
    if (const int code = waitForJob(farm, started.at("pilot"), console); code != kDone) return code;
    return showForecast(farm, started.at("forecast"), false, console);
}

}  // namespace

JobSpec uploadScene(FarmClient& farm, const SubmitOptions& options, const Console& console) {
    const BundledScene scene = bundleScene(options.scene, options.environment, options.spec);
    for (const std::string& warning : scene.warnings) console.err << "warning: " << warning << '\n';
    JobSpec spec = options.spec;
    spec.scene = scene.bundle;
    if (spec.name.empty()) spec.name = options.scene.stem().string();
    const std::vector<std::byte> entry = readWhole(options.scene);
    spec.image = pictureSize(bytesOfGltf(entry), spec);
    jobFromJson(toJson(spec));  // every fault now, before anything is sent

    uploadMissing(farm, scene, console);
    return spec;
}

int submit(FarmClient& farm, const SubmitOptions& options, const Console& console) {
    const JobSpec spec = uploadScene(farm, options, console);
    if (options.dryRun) return forecastJob(farm, spec, console);
    const std::string id = farm.submit(spec).at("id");
    console.out << id << std::endl;
    const PictureOptions& wanted = options.pictures;
    if (!options.wait && wanted.exr.empty() && wanted.png.empty()) return kDone;

    if (const int code = waitForJob(farm, id, console); code != kDone) return code;
    for (const int32_t frame : frameNumbers(spec.frames)) {
        PictureOptions pictures = wanted;
        if (spec.frames.count > 1) {
            if (!wanted.exr.empty()) pictures.exr = numbered(wanted.exr, frame);
            if (!wanted.png.empty()) pictures.png = numbered(wanted.png, frame);
        }
        downloadFrame(farm, id, frame, pictures, console);
    }
    return kDone;
}

}  // namespace tilefarm
