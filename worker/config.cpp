#include "worker/config.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <fstream>

#include "shared/error/error.h"
#include "shared/job/job_options.h"

namespace fs = std::filesystem;

namespace tilefarm {
namespace {

fs::path defaultCache() {
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder)
        return fs::path(folder) / "tilefarm";
    if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "tilefarm";
    return fs::temp_directory_path() / "tilefarm-cache";
}

std::string firstLineOf(const fs::path& file) {
    std::ifstream in(file);
    std::string line;
    if (!std::getline(in, line) || line.empty())
        throw CLI::ValidationError("--token-file",
                                   file.string() + " cannot be read or begins with an empty line");
    while (line.ends_with('\r') || line.ends_with(' ')) line.pop_back();
    return line;
}

// What the options are read into before they are made sense of.
struct Words {
    std::string device, tokenFile, tone = "pbrNeutral";
    double cacheGb = 20;
    std::string frames = "0";
    std::vector<uint32_t> pixel;
    uint32_t sample = 0;
};

DeviceChoice deviceFrom(const std::string& word) {
    if (word.empty()) return {};
    if (word == "all") return {std::nullopt, true};
    if (word.size() > 6 || word.find_first_not_of("0123456789") != std::string::npos)
        throw CLI::ValidationError("--device", "'" + word + "' is neither a number nor 'all'");
    return {static_cast<uint32_t>(std::stoul(word)), false};
}

CLI::Option* addDevice(CLI::App& app, Words& words, const char* about) {
    return app.add_option("--device", words.device, about);
}

void addAgentOptions(CLI::App& app, AgentConfig& agent, Words& words) {
    app.add_option("--server", agent.server, "URL of the server, like http://host:8700");
    addDevice(app, words,
              "number of a device as 'tilefarm-worker devices' lists it, or 'all': every GPU "
              "(the CPU if there is none); default: the first GPU, else the CPU");
    app.add_option("--token-file", words.tokenFile, "file whose first line is the server's token");
    app.add_option("--cache-limit", words.cacheGb,
                   "largest size of the cached scene files, GB; the oldest are deleted first")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1e6));
    app.add_option("--name", agent.name, "name of this worker in lists; default: the host name");
    app.add_option("--want-seconds", agent.wantSeconds, "seconds of work to request per lease")
        ->capture_default_str()
        ->check(CLI::Range(0.1, 600.0));
}

void addRenderOptions(CLI::App& app, RenderConfig& config, Words& words) {
    app.add_option("scene", config.render.files.entry, ".gltf or .glb")->required();
    CLI::Option* output = app.add_option("-o,--output", config.render.exr, "EXR file to write");
    CLI::Option* pixel =
        app.add_option("--pixel", words.pixel,
                       "X,Y: print the path of one sample of this pixel bounce by bounce; writes no file")
            ->delimiter(',')
            ->expected(2)
            ->excludes(output);
    app.add_option("--sample", words.sample, "index of the sample that --pixel prints")
        ->capture_default_str()
        ->needs(pixel);
    app.add_option("--png", config.render.png, "PNG file to write as well");
    app.add_option("--report", config.render.report, "JSON file to write: time, error, features, warnings");
    app.add_option("--environment", config.render.files.environment,
                   "environment map: .hdr, .exr, .png or .jpg, equirectangular or an .exr cube map");
    addPictureOptions(app, config.render.spec);
    app.add_option("--frame,--frames", words.frames,
                   "frame numbers and ranges: 7, 1-48, 1-100x10 (every tenth), 1,5,9; with several, ### in a "
                   "file name becomes the frame number")
        ->capture_default_str();
    app.add_option("--exposure", config.render.tone.exposure, "exposure of the PNG, stops")
        ->capture_default_str();
    app.add_option("--tone", words.tone, "tone curve of the PNG: linear, aces or pbrNeutral")
        ->capture_default_str();
    addDevice(app, words, "number of a device as 'tilefarm-worker devices' lists it");
    app.add_flag("--validation", config.validation, "enable Vulkan's validation layers");
}

AgentConfig finished(AgentConfig agent, const Words& words) {
    if (agent.server.empty()) throw CLI::RequiredError("--server");
    agent.device = deviceFrom(words.device);
    if (!words.tokenFile.empty()) agent.token = firstLineOf(words.tokenFile);
    agent.cacheBytes = static_cast<uint64_t>(words.cacheGb * 1e9);
    return agent;
}

RenderConfig finished(RenderConfig config, const Words& words) {
    config.device = deviceFrom(words.device);
    if (config.device.all) throw CLI::ValidationError("--device", "a local render uses one device");
    try {
        config.render.spec.frames = framesFrom(words.frames);
    } catch (const Error& error) {
        throw CLI::ValidationError("--frame", error.what());
    }
    if (!words.pixel.empty()) config.render.pixel = {words.pixel[0], words.pixel[1], words.sample};
    if (!config.render.pixel && config.render.exr.empty()) throw CLI::RequiredError("--output");
    try {
        config.render.tone.curve = toneCurveFrom(words.tone);
    } catch (const Error& error) {
        throw CLI::ValidationError("--tone", error.what());
    }
    try {
        requireValid(config.render);
    } catch (const Error& error) {
        std::string faults;
        for (const Fault& fault : error.faults)
            faults += (faults.empty() ? "" : "\n        ") + fault.pointer + " " + fault.message;
        throw CLI::ValidationError("render", faults);
    }
    return config;
}

}  // namespace

std::variant<WorkerConfig, ExitNow> parseCommandLine(int argc, const char* const* argv) {
    WorkerConfig config;
    AgentConfig agent;
    RenderConfig render;
    DevicesConfig devices;
    Words words;
    config.cache = defaultCache();

    CLI::App app("Tilefarm's worker: renders for a server, or (render) a scene of this machine.",
                 "tilefarm-worker");
    app.set_version_flag("--version", TILEFARM_VERSION);
    app.require_subcommand(0, 1);
    app.fallthrough();
    app.add_option("--cache", config.cache,
                   "folder for scene files, compiled kernels and results not uploaded yet")
        ->capture_default_str();
    app.add_flag("--verbose", config.verbose, "also log debug messages");
    addAgentOptions(app, agent, words);
    CLI::App* renderCommand =
        app.add_subcommand("render", "Renders a scene of this machine without a server");
    addRenderOptions(*renderCommand, render, words);
    CLI::App* devicesCommand = app.add_subcommand("devices", "Lists the Vulkan devices of this machine");
    devicesCommand->add_flag("--json", devices.json, "as JSON");
    try {
        app.parse(argc, argv);
        if (renderCommand->parsed())
            config.command = finished(std::move(render), words);
        else if (devicesCommand->parsed())
            config.command = devices;
        else
            config.command = finished(std::move(agent), words);
    } catch (const CLI::ParseError& error) {
        return ExitNow{app.exit(error) == 0 ? 0 : 2};
    }
    return config;
}

}  // namespace tilefarm
