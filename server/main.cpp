// Wires the server. Order of construction is order of use: the folder is locked first and released last.
#include <signal.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <atomic>
#include <cstdio>

#include "server/api/http_server.h"
#include "server/api/services.h"
#include "server/config.h"
#include "server/housekeeper.h"
#include "server/store/file_blob_store.h"
#include "server/store/folder_lock.h"
#include "server/store/sqlite_job_store.h"
#include "server/study_keeper.h"

namespace tilefarm {
namespace {

// Blocks the signals for every thread made later; wait() takes them.
class StopSignal {
public:
    StopSignal() {
        sigemptyset(&set_);
        sigaddset(&set_, SIGINT);
        sigaddset(&set_, SIGTERM);
        pthread_sigmask(SIG_BLOCK, &set_, nullptr);
        signal(SIGPIPE, SIG_IGN);
    }
    void wait() const {
        int which = 0;
        sigwait(&set_, &which);
    }

private:
    sigset_t set_{};
};

// A connection is a file; shells allow 1,024.
void allowManyFiles() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
}

void reportSweep(Scheduler& scheduler) {
    for (const Violation& v : scheduler.sweep()) {
        spdlog::warn("at start: invariant {} broken at {}{}", v.invariant, v.detail,
                     v.repaired ? ", repaired" : "");
    }
}

void removeLeftovers(const JobStore& store, FilmStore& films, FrameImages& images) {
    std::vector<std::string> held;
    store.read([&](const ConstTables& t) {
        for (const PassRow& row : t.passes.held()) held.push_back(row.held->file);
    });
    films.removeHeldExcept(held);
    images.removeSpentFilms();
}

std::string urlOf(const HttpConfig& http, int port) {
    const bool ipv6 = http.host.find(':') != std::string::npos;
    return "http://" + (ipv6 ? "[" + http.host + "]" : http.host) + ":" + std::to_string(port);
}

void serve(const ServerConfig& config, const StopSignal& stop) {
    const FolderLock lock(config.data);
    const SystemClock clock;
    SqliteJobStore store(config.data / "tilefarm.sqlite");
    FileBlobStore blobs(config.data / "blobs");
    EventBus events;
    Metrics metrics;
    std::atomic<Housekeeper*> housekeeper = nullptr;
    Scheduler scheduler(store, clock, config.queue, [&] {
        events.publish();
        if (Housekeeper* keeper = housekeeper) keeper->wake();
    });
    FilmStore films(config.data);
    FrameImages images(store, scheduler, films, blobs, clock, config.data);
    ResultMerger merger(store, scheduler, films);
    reportSweep(scheduler);
    removeLeftovers(store, films, images);

    StudyRunner studies(store, scheduler, images, clock);
    Services services{config.api, clock, store, blobs, scheduler, merger, images, events, metrics, studies};
    Housekeeper keeper(scheduler, images, metrics);  // outlives the server, whose requests wake it
    housekeeper = &keeper;
    const StudyKeeper studyKeeper(studies);
    HttpServer server(services, config.http);
    fmt::print("listening on {}\n", urlOf(config.http, server.port()));
    std::fflush(stdout);
    stop.wait();
    spdlog::info("stopping");
    events.close();
    server.stop();
}

}  // namespace
}  // namespace tilefarm

int main(int argc, char** argv) {
    try {
        const tilefarm::StopSignal stop;
        const auto config = tilefarm::parseCommandLine(argc, argv);
        spdlog::set_default_logger(spdlog::stderr_color_mt("server"));
        tilefarm::allowManyFiles();
        spdlog::set_level(config.verbose ? spdlog::level::debug : spdlog::level::info);
        tilefarm::serve(config, stop);
        return 0;
    } catch (const std::exception& fault) {
        fmt::print(stderr, "tilefarm-server: {}\n", fault.what());
        return 1;
    }
}
