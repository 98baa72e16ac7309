#include "worker/agent/fleet.h"

#include <spdlog/spdlog.h>

#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "worker/agent/uploader.h"

namespace tilefarm {
namespace {

// The two helpers of an agent, ended in the order that loses nothing: first every result is on its way
// or on disk, and only then are leases no longer renewed.
class Helpers {
public:
    Helpers(Uploader& uploader, ResultQueue& queue, LeaseKeeper& keeper)
        : queue_(queue),
          keeper_(keeper),
          uploading_([&uploader] { uploader.run(); }),
          renewing_([&keeper] { keeper.run(); }) {}
    ~Helpers() {
        queue_.close();
        uploading_.join();
        keeper_.end();
        renewing_.join();
    }
    Helpers(const Helpers&) = delete;
    Helpers& operator=(const Helpers&) = delete;

private:
    ResultQueue& queue_;
    LeaseKeeper& keeper_;
    std::thread uploading_, renewing_;
};

void runMember(const FleetParts& parts, const FleetMember& member, Standing& standing,
               const std::vector<std::filesystem::path>& leftBehind, uint32_t seed) {
    const auto backend = member.makeBackend();
    const auto asking = parts.makeFarm(), uploading = parts.makeFarm(), renewing = parts.makeFarm();
    LeaseKeeper keeper(*renewing, standing, parts.clock);
    ResultQueue queue;
    Uploader uploader({*uploading, queue, parts.store, keeper, standing, parts.stop, parts.clock}, seed);
    for (const auto& file : leftBehind) {
        FinishedResult result;
        result.file = file;
        queue.push(std::move(result));
    }
    const DeviceName device = backend->device();
    Agent agent({*asking, *backend, parts.cache, keeper, queue, standing, parts.stop, parts.clock},
                {member.worker, parts.host, device.name, device.driver, parts.version, parts.store.session(),
                 parts.store.crashed()},
                parts.wantSeconds, seed + 1);
    spdlog::info("{}: {} ({})", member.worker, device.name, device.driver);
    const Helpers helpers(uploader, queue, keeper);
    agent.run();
}

}  // namespace

std::vector<std::string> runFleet(const FleetParts& parts, const std::vector<FleetMember>& members) {
    Standing standing([&parts] { parts.stop.stop(); });
    std::mutex mutex;
    std::vector<std::string> faults;
    std::vector<std::filesystem::path> leftBehind = parts.store.adopt();
    if (!leftBehind.empty()) spdlog::info("{} results of an earlier run to upload", leftBehind.size());
    std::vector<std::thread> threads;
    uint32_t seed = parts.seed;
    for (const FleetMember& member : members) {
        threads.emplace_back([&, files = std::exchange(leftBehind, {}), mine = seed] {
            try {
                runMember(parts, member, standing, files, mine);
            } catch (const std::exception& error) {
                spdlog::error("{}: {}", member.worker, error.what());
                const std::lock_guard lock(mutex);
                faults.emplace_back(error.what());
            }
        });
        seed += 2;
    }
    for (auto& thread : threads) thread.join();
    if (const auto why = standing.stopped()) faults.push_back(*why);
    return faults;
}

}  // namespace tilefarm
