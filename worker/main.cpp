// Wires the worker: an agent for each device, a local render, or the list of devices.
#include <fmt/format.h>
#include <pthread.h>
#include <signal.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "shaders/gpu_types.h"
#include "shared/error/error.h"
#include "worker/agent/device_backend.h"
#include "worker/agent/fleet.h"
#include "worker/agent/http_farm.h"
#include "worker/config.h"

namespace tilefarm {
namespace {

std::string hostName() {
    char name[256] = {};
    return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

// The first SIGINT or SIGTERM stops the worker in good order, the second at once. Made before any
// thread, so that only its own thread gets the signals.
class StopSignals {
public:
    explicit StopSignals(StopSwitch& stop) {
        sigset_t set;
        sigemptyset(&set);
        sigaddset(&set, SIGINT);
        sigaddset(&set, SIGTERM);
        pthread_sigmask(SIG_BLOCK, &set, nullptr);
        std::thread([set, &stop] {
            int signal = 0;
            sigwait(&set, &signal);
            spdlog::info("stopping after the passes being rendered; repeat the signal to stop at once");
            stop.stop();
            sigwait(&set, &signal);
            _exit(128 + signal);
        }).detach();
    }
};

// For tests of what becomes of faults: TILEFARM_INJECT_FAULTS=1 makes one sample of 1e5 NaN.
uint64_t injectedFaults() {
    const char* wanted = std::getenv("TILEFARM_INJECT_FAULTS");
    return wanted && std::string_view(wanted) == "1" ? gpu::bit(gpu::FEATURE_FAULT_INJECTION) : 0;
}

std::vector<uint32_t> chosenDevices(const DeviceChoice& choice) {
    if (!choice.all) return {choice.index ? *choice.index : gpu::defaultDevice()};
    std::vector<uint32_t> gpus, software;
    for (const gpu::DeviceInfo& device : gpu::listDevices())
        if (device.usable) (device.cpu ? software : gpus).push_back(device.index);
    if (gpus.empty() && software.empty()) throw Error(ErrorCode::notFound, "no Vulkan device is usable");
    return gpus.empty() ? software : gpus;
}

std::vector<FleetMember> membersFor(const AgentConfig& config, uint32_t salt) {
    const std::string name = config.name.empty() ? hostName() : config.name;
    std::vector<FleetMember> members;
    for (const uint32_t device : chosenDevices(config.device))
        members.push_back({fmt::format("{}-{}-{:04x}-{}", name, getpid(), salt & 0xFFFF, device),
                           [device] { return makeDeviceBackend(device, {}, injectedFaults()); }});
    return members;
}

void keepShaders(const WorkerConfig& config) {
    const std::filesystem::path shared = gpu::shaderCacheByEnvironment();
    gpu::useShaderCache(shared.empty() ? config.cache / "shaders" : shared);
}

int runAgent(const WorkerConfig& config, const AgentConfig& agent) {
    // Never destroyed: its thread may be using the switch while the process ends.
    static StopSwitch& stop = *new StopSwitch;
    const StopSignals signals(stop);
    keepShaders(config);
    const SystemClock clock;
    const uint32_t salt = std::random_device{}();
    makeHttpFarm(agent.server, agent.token);  // refuses what is no URL before anything starts
    BlobCache cache(config.cache, agent.cacheBytes);
    ResultStore store(config.cache / "results", agent.server);
    const FleetParts parts{[&] { return makeHttpFarm(agent.server, agent.token); },
                           cache,
                           store,
                           stop,
                           clock,
                           hostName(),
                           TILEFARM_VERSION,
                           agent.wantSeconds,
                           salt};
    const std::vector<std::string> faults = runFleet(parts, membersFor(agent, salt));
    for (const std::string& fault : faults) fmt::print(stderr, "tilefarm-worker: {}\n", fault);
    return faults.empty() ? 0 : 1;
}

int runRender(const WorkerConfig& config, const RenderConfig& render) {
    keepShaders(config);
    const auto backend = [&] {
        const uint32_t device = render.device.index ? *render.device.index : gpu::defaultDevice();
        const uint64_t traced = render.render.pixel ? gpu::bit(gpu::FEATURE_TRACE) : 0;
        return makeDeviceBackend(device, {.validation = render.validation}, injectedFaults() | traced);
    };
    runLocalRender(render.render, backend, SystemClock(), stderr);
    return 0;
}

int listDevices(const DevicesConfig& config) {
    const std::vector<gpu::DeviceInfo> devices = gpu::listDevices();
    auto list = nlohmann::json::array();
    for (const gpu::DeviceInfo& d : devices) {
        list.push_back({{"index", d.index},
                        {"name", d.name},
                        {"driver", d.driver},
                        {"apiVersion", d.apiVersion},
                        {"cpu", d.cpu},
                        {"usable", d.usable},
                        {"unusableWhy", d.unusableWhy}});
        if (!config.json)
            fmt::print("{:>3}  {:<40} {:<36} Vulkan {:<10} {:<8} {}\n", d.index, d.name, d.driver,
                       d.apiVersion, d.cpu ? "software" : "GPU",
                       d.usable ? "usable" : "not usable: " + d.unusableWhy);
    }
    if (config.json) fmt::print("{}\n", nlohmann::json{{"devices", list}}.dump(2));
    if (devices.empty() && !config.json) fmt::print(stderr, "there is no Vulkan device\n");
    return 0;
}

int run(const WorkerConfig& config) {
    spdlog::set_default_logger(spdlog::stderr_color_mt("worker"));
    spdlog::set_level(config.verbose ? spdlog::level::debug : spdlog::level::info);
    if (const auto* agent = std::get_if<AgentConfig>(&config.command)) return runAgent(config, *agent);
    if (const auto* render = std::get_if<RenderConfig>(&config.command)) return runRender(config, *render);
    return listDevices(std::get<DevicesConfig>(config.command));
}

}  // namespace
}  // namespace tilefarm

int main(int argc, char** argv) {
    try {
        const auto parsed = tilefarm::parseCommandLine(argc, argv);
        if (const auto* exitNow = std::get_if<tilefarm::ExitNow>(&parsed)) return exitNow->code;
        return tilefarm::run(std::get<tilefarm::WorkerConfig>(parsed));
    } catch (const std::exception& error) {
        fmt::print(stderr, "tilefarm-worker: {}\n", error.what());
        return 1;
    }
}
