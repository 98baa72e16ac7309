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
                    fmt::format("there is no token in '{}'", arguments.tokenFile));
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
    command.add_option("--exposure", a.exposure, "stops, for the PNG")->capture_default_str();
    command.add_option("--tone", a.tone, "tone curve of the PNG: linear, aces or pbrNeutral")
        ->capture_default_str()
        ->check(CLI::IsMember({"linear", "aces", "pbrNeutral"}));
}

void addDenoised(CLI::App& command, Arguments& a) {
    command.add_flag("--denoised", a.denoised,
                     "PNGs show the picture without its noise, of jobs with output.denoise; biased");
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
        app_.add_option("--token-file", a_.tokenFile, "file with the server's token; else TILEFARM_TOKEN");
        addSubmit();
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
        CLI::App& c = command("submit", "send a scene to be rendered and print the job's id",
                              online([this](FarmClient& farm) {
                                  a_.submit.pictures.tone = toneOf(a_);
                                  a_.submit.pictures.denoised = a_.denoised;
                                  return submit(farm, a_.submit, console_);
                              }));
        c.add_option("scene", a_.submit.scene, "a .gltf or .glb")->required();
        c.add_option("--environment", a_.submit.environment,
                     "a picture of all directions: .hdr, .exr, .png or .jpg");
        addJobOptions(c, a_.submit.spec);
        c.add_flag("--wait", a_.submit.wait, "follow the job until it ends");
        c.add_option("-o,--output", a_.submit.pictures.exr,
                     "wait and write the EXR here; ### is the frame's number");
        c.add_option("--png", a_.submit.pictures.png, "wait and write a PNG here");
        addTone(c, a_);
        addDenoised(c, a_);
    }

    void addLooks() {
        CLI::App& jobs =
            command("jobs", "list the jobs",
                    online([this](FarmClient& farm) { return showJobs(farm, a_.state, a_.json, console_); }));
        jobs.add_option("--state", a_.state, "only those in this state");
        jobs.add_flag("--json", a_.json, "as JSON");
        CLI::App& job =
            command("job", "show one job",
                    online([this](FarmClient& farm) { return showJob(farm, a_.job, a_.json, console_); }));
        job.add_option("id", a_.job, "the job")->required();
        job.add_flag("--json", a_.json, "as JSON");
        CLI::App& wait =
            command("wait", "follow a job until it ends",
                    online([this](FarmClient& farm) { return waitForJob(farm, a_.job, console_); }));
        wait.add_option("id", a_.job, "the job")->required();
        CLI::App& workers =
            command("workers", "list the workers",
                    online([this](FarmClient& farm) { return showWorkers(farm, a_.json, console_); }));
        workers.add_flag("--json", a_.json, "as JSON");
    }

    void addMoves() {
        for (const auto& [name, meaning, move] :
             {std::tuple{"cancel", "end a job; what is rendered so far stays", Move::cancel},
              {"pause", "hand out no more of a job", Move::pause},
              {"resume", "go on with a paused job", Move::resume}}) {
            const Move to = move;
            command(name, meaning,
                    online([this, to](FarmClient& farm) { return moveJob(farm, a_.job, to, console_); }))
                .add_option("id", a_.job, "the job")
                ->required();
        }
    }

    void addDownload() {
        CLI::App& c = command(
            "download", "get a frame's picture, also while it renders", online([this](FarmClient& farm) {
                const bool zip = hasSuffix(a_.output.string(), ".zip");
                if (!zip) pictureFor(a_);  // refuses other suffixes
                if (zip && a_.frames.empty()) a_.frames = "all";
                if (!a_.frames.empty())
                    return downloadFrames(farm, a_.job, a_.frames, a_.output, looksOf(a_), console_);
                return download(farm, a_.job, frameOf(a_), pictureFor(a_), console_);
            }));
        c.add_option("id", a_.job, "the job")->required();
        CLI::Option* frame = c.add_option("--frame", a_.frame, "number of the frame; else the first");
        c.add_option(
             "--frames", a_.frames,
             "several: all, 1-48, 1-100x10 (every tenth), 1,5,9; ### in the file's name is the number")
            ->excludes(frame);
        c.add_option("-o,--output", a_.output, "a file that ends with .exr or .png, or a .zip of EXRs")
            ->required();
        addTone(c, a_);
        addDenoised(c, a_);
        CLI::App& movie =
            command("movie", "make a movie of a job's frames, with ffmpeg", online([this](FarmClient& farm) {
                        return makeMovie(farm, a_.job, a_.output, a_.fps, looksOf(a_), console_);
                    }));
        movie.add_option("id", a_.job, "the job")->required();
        movie.add_option("-o,--output", a_.output, "a file that ends with .mp4, .webm, .gif, …")->required();
        movie.add_option("--fps", a_.fps, "frames a second; else the job's own")
            ->check(CLI::Range(0.001, 1000.0));
        addTone(movie, a_);
        addDenoised(movie, a_);
    }

    void addImageTools() {
        CLI::App& compareCommand = command("compare", "tell how far an EXR is from a reference",
                                           [this] { return compare(a_.compare, console_); });
        compareCommand.add_option("a", a_.compare.a, "an EXR")->required();
        compareCommand.add_option("b", a_.compare.b, "the reference")->required();
        compareCommand.add_flag("--json", a_.compare.json, "as JSON");
        compareCommand.add_flag("--identical", a_.compare.identical,
                                "fail unless every channel has the same bits");
        compareCommand.add_option("--max-relmse", a_.compare.maxRelMse, "fail above this");

        CLI::App& png = command("png", "show an EXR as a PNG", [this] {
            return convertToPng(a_.input, a_.output, a_.channel, toneOf(a_), console_);
        });
        png.add_option("exr", a_.input, "an EXR")->required();
        png.add_option("-o,--output", a_.output, "the PNG")->required();
        png.add_option(
            "--channel", a_.channel,
            "a layer (denoised, albedo, normal, variance) or channel (Z, samples) instead of the picture");
        addTone(png, a_);

        CLI::App& denoised = command(
            "denoise", "add the picture without its noise to an EXR, beside the raw one; it is biased",
            [this] { return denoiseFile(a_.input, a_.output, a_.wrap, console_); });
        denoised.add_option("in", a_.input, "an EXR of a frame")->required();
        denoised
            .add_option("out", a_.output, "the EXR with channels denoised.R, denoised.G, denoised.B as well")
            ->required();
        denoised.add_flag("--wrap", a_.wrap, "left and right edge meet; of itself where the file says so");
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
            Error(ErrorCode::internal, fmt::format("the server's answer is not as agreed: {}", e.what())),
            console);
    } catch (const std::exception& e) {
        return report(Error(ErrorCode::internal, e.what()), console);
    }
}

}  // namespace tilefarm
