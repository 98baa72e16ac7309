#include "server/cli/cli.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "server/cli/commands.h"
#include "shared/error/error.h"
#include "shared/job/job_options.h"
#include "shared/job/safe_path.h"

namespace tilefarm {

namespace {

constexpr const char* kDefaultServer = "http://127.0.0.1:8700";

// All that the words may set. One object per run; the commands take what is theirs.
struct Arguments {
    std::string server = kDefaultServer;
    std::string tokenFile;
    std::string job, state;
    bool json = false;
    SubmitOptions submit;
    StudyOptions study;
    bool cancel = false;
    std::filesystem::path output, input;
    std::string frame, frames, channel, tone = "pbrNeutral";
    float exposure = 0;
    bool denoised = false, wrap = false;
    double fps = 0;
    CompareOptions compare;
};

std::string tokenOf(const Arguments& arguments) {
    if (arguments.tokenFile.empty()) {
        const char* token = std::getenv("TILEFARM_TOKEN");
        return token ? token : "";
    }
    std::ifstream file(arguments.tokenFile);
    std::string token;
    if (!(file >> token))
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("--token-file '{}' cannot be read or is empty", arguments.tokenFile));
    return token;
}

ToneMapping toneOf(const Arguments& arguments) {
    return {toneCurveFrom(arguments.tone), arguments.exposure};
}

PictureOptions looksOf(const Arguments& arguments) {
    return {.exr = {}, .png = {}, .tone = toneOf(arguments), .denoised = arguments.denoised};
}

PictureOptions pictureFor(const Arguments& arguments) {
    PictureOptions pictures = looksOf(arguments);
    const std::string name = arguments.output.string();
    if (hasSuffix(name, ".exr"))
        pictures.exr = arguments.output;
    else if (hasSuffix(name, ".png"))
        pictures.png = arguments.output;
    else
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("the output '{}' must end with .exr or .png", name));
    return pictures;
}

std::optional<int32_t> frameOf(const Arguments& arguments) {
    if (arguments.frame.empty()) return std::nullopt;
    const FrameSet frame = framesFrom(arguments.frame);
    if (frame.count != 1)
        throw Error(ErrorCode::invalidArgument, "--frame takes one frame; --frames takes several");
    return frame.first;
}

void addTone(CLI::App& command, Arguments& a) {
    command.add_option("--exposure", a.exposure, "exposure of the PNG, stops")->capture_default_str();
    command.add_option("--tone", a.tone, "tone curve of the PNG: linear, aces or pbrNeutral")
        ->capture_default_str()
        ->check(CLI::IsMember({"linear", "aces", "pbrNeutral"}));
}

void addDenoised(CLI::App& command, Arguments& a) {
    command.add_flag("--denoised", a.denoised,
                     "PNGs show the denoised picture, which is biased; for jobs with output.denoise");
}

using Run = std::function<int()>;

// A command with what it does once the words are parsed.
CLI::App& addCommand(CLI::App& app, Run& chosen, const char* name, const char* meaning, Run run) {
    CLI::App* command = app.add_subcommand(name, meaning);
    command->callback([&chosen, run = std::move(run)] { chosen = run; });
    return *command;
}

class Program {
public:
    explicit Program(const Console& console) : console_(console) {
        app_.require_subcommand(1);
        app_.fallthrough();
        app_.set_version_flag("--version", std::string("tilefarm ") + TILEFARM_VERSION);
        app_.add_option("--server", a_.server, "URL of the server")
            ->envname("TILEFARM_SERVER")
            ->capture_default_str();
        app_.add_option("--token-file", a_.tokenFile,
                        "file with the server's token; default: the variable TILEFARM_TOKEN");
        addSubmit();
        addStudies();
        addLooks();
        addMoves();
        addDownload();
        addImageTools();
    }

    int run(const std::vector<std::string>& words) {
        try {
            app_.parse(std::vector<std::string>(words.rbegin(), words.rend()));
        } catch (const CLI::ParseError& e) {
            return app_.exit(e, console_.out, console_.err) == 0 ? kDone : kUsage;
        }
        return chosen_();
    }

private:
    // Runs `work` with a connection to the server.
    template <typename Work>
    Run online(Work work) {
        return [this, work] {
            FarmClient farm(a_.server, tokenOf(a_));
            return work(farm);
        };
    }

    CLI::App& command(const char* name, const char* meaning, Run run) {
        return addCommand(app_, chosen_, name, meaning, std::move(run));
    }

    void addSubmit() {
        CLI::App& c = command("submit", "upload a scene, submit a job and print its id",
                              online([this](FarmClient& farm) {
                                  a_.submit.pictures.tone = toneOf(a_);
                                  a_.submit.pictures.denoised = a_.denoised;
                                  return submit(farm, a_.submit, console_);
                              }));
        c.add_option("scene", a_.submit.scene, "a .gltf or .glb")->required();
        c.add_option("--environment", a_.submit.environment,
                     "environment map: .hdr, .exr, .png or .jpg, equirectangular or an .exr cube map");
        addJobOptions(c, a_.submit.spec);
        c.add_flag("--wait", a_.submit.wait,
                   "show the job's progress until it ends; exit with 1 unless it completed");
        c.add_flag(
            "--dry-run", a_.submit.dryRun,
            "render a pilot of 16 samples per pixel and tell what the job would take to several relative "
            "errors; the job itself is not submitted");
        c.add_option("-o,--output", a_.submit.pictures.exr,
                     "wait, then write the EXR to this file; ### becomes the frame number");
        c.add_option("--png", a_.submit.pictures.png, "wait, then write a PNG to this file");
        addTone(c, a_);
        addDenoised(c, a_);
    }

    void addStudies() {
        StudyOptions& study = a_.study;
        CLI::App& c =
            command("study", "compare settings of a scene: which knob is worth its time",
                    online([this](FarmClient& farm) { return submitStudy(farm, a_.study, console_); }));
        c.add_option("scene", study.base.scene, "a .gltf or .glb")->required();
        c.add_option("--environment", study.base.environment, "environment map, as for submit");
        c.add_option("--knob", study.knobs,
                     "a member of the job and values, as settings.clampIndirect=1,10; may be repeated")
            ->required()
            ->take_all()
            ->allow_extra_args(false);
        c.add_flag("--grid", study.grid, "all combinations of the values; default: one knob at a time");
        c.add_option(
             "--sample-counts", study.samples,
             "samples per pixel to compare at, as 4,16,64; default: a sixteenth, a quarter and all of "
             "--samples")
            ->delimiter(',');
        c.add_option("--seeds", study.seeds, "pictures of each variant, with different seeds")
            ->capture_default_str();
        c.add_option("--reference-samples", study.referenceSamples,
                     "samples per pixel of the reference; default: 16 times the most of the study");
        c.add_option("--priority", study.priority, "of the study's jobs")->capture_default_str();
        c.add_option("--name", study.base.spec.name, "shown in lists");
        addPictureOptions(c, study.base.spec);
        c.add_flag("--wait", study.wait,
                   "wait for its end and print what it found; exit with 1 unless it completed");
        c.add_option("-o,--output", study.reports,
                     "wait, then write a report: a file that ends with .html, .csv or .json")
            ->allow_extra_args(false);
        CLI::App& list = command(
            "studies", "list the studies, or show one: verdict and table", online([this](FarmClient& farm) {
                if (a_.job.empty()) return showStudies(farm, a_.json, console_);
                if (a_.cancel) return cancelStudy(farm, a_.job, console_);
                return showStudy(farm, a_.job, a_.study.wait, a_.study.reports, console_);
            }));
        list.add_option("id", a_.job, "the study");
        list.add_flag("--json", a_.json, "the list as JSON");
        list.add_flag("--cancel", a_.cancel, "end it with its jobs");
        list.add_flag("--wait", study.wait, "wait for its end; exit with 1 unless it completed");
        list.add_option("-o,--output", study.reports,
                        "write a report: a file that ends with .html, .csv or .json")
            ->allow_extra_args(false);
    }

    void addLooks() {
        CLI::App& jobs =
            command("jobs", "list the jobs",
                    online([this](FarmClient& farm) { return showJobs(farm, a_.state, a_.json, console_); }));
        jobs.add_option("--state", a_.state,
                        "only jobs in this state: queued, running, paused, completed, failed or canceled");
        jobs.add_flag("--json", a_.json, "as JSON");
        CLI::App& job =
            command("job", "show one job: progress, error against device time, errors",
                    online([this](FarmClient& farm) { return showJob(farm, a_.job, a_.json, console_); }));
        job.add_option("id", a_.job, "the job")->required();
        job.add_flag("--json", a_.json, "as JSON");
        CLI::App& wait =
            command("wait", "show a job's progress until it ends; exit with 1 unless it completed",
                    online([this](FarmClient& farm) { return waitForJob(farm, a_.job, console_); }));
        wait.add_option("id", a_.job, "the job")->required();
        CLI::App& forecast = command(
            "forecast",
            "tell what a job would take in all to several relative errors, from what is rendered of it",
            online([this](FarmClient& farm) {
                return showForecast(farm, "/v1/jobs/" + a_.job + "/forecast", a_.json, console_);
            }));
        forecast.add_option("id", a_.job, "the job")->required();
        forecast.add_flag("--json", a_.json, "as JSON");
        CLI::App& workers =
            command("workers", "list the workers",
                    online([this](FarmClient& farm) { return showWorkers(farm, a_.json, console_); }));
        workers.add_flag("--json", a_.json, "as JSON");
    }

    void addMoves() {
        for (const auto& [name, meaning, move] :
             {std::tuple{"cancel", "end a job; the picture rendered so far can still be downloaded",
                         Move::cancel},
              {"pause", "hand out no more work of a job until it is resumed", Move::pause},
              {"resume", "continue a paused job", Move::resume}}) {
            const Move to = move;
            command(name, meaning,
                    online([this, to](FarmClient& farm) { return moveJob(farm, a_.job, to, console_); }))
                .add_option("id", a_.job, "the job")
                ->required();
        }
    }

    void addDownload() {
        CLI::App& c =
            command("download", "download a frame's picture, also while it is being rendered",
                    online([this](FarmClient& farm) {
                        const bool zip = hasSuffix(a_.output.string(), ".zip");
                        if (!zip) pictureFor(a_);  // refuses other suffixes
                        if (zip && a_.frames.empty()) a_.frames = "all";
                        if (!a_.frames.empty())
                            return downloadFrames(farm, a_.job, a_.frames, a_.output, looksOf(a_), console_);
                        return download(farm, a_.job, frameOf(a_), pictureFor(a_), console_);
                    }));
        c.add_option("id", a_.job, "the job")->required();
        CLI::Option* frame =
            c.add_option("--frame", a_.frame, "frame number; default: the job's first frame");
        c.add_option("--frames", a_.frames,
                     "several frames: all, 1-48, 1-100x10 (every tenth), 1,5,9; ### in the file name becomes "
                     "the number")
            ->excludes(frame);
        c.add_option("-o,--output", a_.output, "a file that ends with .exr or .png, or a .zip of EXRs")
            ->required();
        addTone(c, a_);
        addDenoised(c, a_);
        CLI::App& movie = command(
            "movie", "encode a job's frames as a movie, with ffmpeg", online([this](FarmClient& farm) {
                return makeMovie(farm, a_.job, a_.output, a_.fps, looksOf(a_), console_);
            }));
        movie.add_option("id", a_.job, "the job")->required();
        movie.add_option("-o,--output", a_.output, "a file that ends with .mp4, .webm, .gif, …")->required();
        movie.add_option("--fps", a_.fps, "frames per second; default: the job's motion.fps")
            ->check(CLI::Range(0.001, 1000.0));
        addTone(movie, a_);
        addDenoised(movie, a_);
    }

    void addImageTools() {
        CLI::App& compareCommand = command(
            "compare", "measure the difference of an EXR from a reference: RMSE, relMSE, MAPE, FLIP, mean, …",
            [this] {
                a_.compare.tone = toneOf(a_);
                return compare(a_.compare, console_);
            });
        compareCommand.add_option("a", a_.compare.a, "the EXR to measure")->required();
        compareCommand.add_option("b", a_.compare.b, "the reference EXR")->required();
        compareCommand.add_flag("--json", a_.compare.json, "as JSON");
        addTone(compareCommand, a_);
        compareCommand.add_flag("--identical", a_.compare.identical,
                                "exit with 1 unless all channels are bit-identical");
        compareCommand.add_option("--max-relmse", a_.compare.maxRelMse,
                                  "exit with 1 if relMSE is above this");

        CLI::App& png = command("png", "convert an EXR to a PNG", [this] {
            return convertToPng(a_.input, a_.output, a_.channel, toneOf(a_), console_);
        });
        png.add_option("exr", a_.input, "the EXR")->required();
        png.add_option("-o,--output", a_.output, "the PNG")->required();
        png.add_option(
            "--channel", a_.channel,
            "show a layer (denoised, albedo, normal, variance) or channel (Z, samples) in place of R, G, B");
        addTone(png, a_);

        CLI::App& denoised = command(
            "denoise",
            "denoise a frame's EXR: adds biased channels denoised.R, .G and .B beside the raw picture",
            [this] { return denoiseFile(a_.input, a_.output, a_.wrap, console_); });
        denoised.add_option("in", a_.input, "the EXR of a frame")->required();
        denoised.add_option("out", a_.output, "the EXR to write")->required();
        denoised.add_flag(
            "--wrap", a_.wrap,
            "the left and right edges are adjacent, as in a panorama; automatic for Tilefarm's panoramas");
    }

    const Console& console_;
    Arguments a_;
    Run chosen_;
    CLI::App app_{"Tilefarm: renders glTF scenes on many machines", "tilefarm"};
};

int report(const Error& error, const Console& console) {
    console.err << "tilefarm: " << error.what() << '\n';
    if (error.faults.size() > 1)
        for (const Fault& fault : error.faults)
            console.err << "  " << fault.pointer << ' ' << fault.message << '\n';
    switch (error.code) {
        case ErrorCode::unavailable: return kUnreachable;
        case ErrorCode::invalidArgument: return kUsage;
        default: return kFailed;
    }
}

}  // namespace

int runCli(const std::vector<std::string>& words, const Console& console) {
    try {
        return Program(console).run(words);
    } catch (const Error& error) {
        return report(error, console);
    } catch (const nlohmann::json::exception& e) {
        return report(
            Error(ErrorCode::internal, fmt::format("unexpected answer of the server: {}", e.what())),
            console);
    } catch (const std::exception& e) {
        return report(Error(ErrorCode::internal, e.what()), console);
    }
}

}  // namespace tilefarm
