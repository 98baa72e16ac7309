// Wires the server. Order of construction is order of use: the folder is locked first and released last.
#include <fcntl.h>
#include <signal.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <thread>

#include "server/api/http_server.h"
#include "server/api/services.h"
#include "server/config.h"
#include "server/store/file.h"
#include "server/store/file_blob_store.h"
#include "server/store/sqlite_job_store.h"
#include "shared/file/durable_file.h"

namespace tilefarm {
namespace {

constexpr Milliseconds kSweepEvery{60000};

// Two servers on one folder would merge into each other's films.
class FolderLock {
public:
    explicit FolderLock(const std::filesystem::path& folder) {
        makeFolder(folder);
        const auto path = folder / "lock";
        fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        if (fd_ < 0) throw fileError("write into the data folder", folder, errno);
        if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
            throw Error(ErrorCode::unavailable,
                        "another server is using the folder '" + folder.string() + "'");
        }
    }
    ~FolderLock() { ::close(fd_); }
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int fd_ = -1;
};

// What happens by itself: leases run out, frames get finished, invariants are checked.
class Housekeeper {
public:
    Housekeeper(Scheduler& scheduler, FrameImages& images, Metrics& metrics)
        : scheduler_(scheduler), images_(images), metrics_(metrics), thread_([this] { run(); }) {}
    ~Housekeeper() {
        {
            const std::scoped_lock lock(mutex_);
            stopping_ = true;
        }
        woken_.notify_all();
        thread_.join();
    }
    void wake() {
        {
            const std::scoped_lock lock(mutex_);
            work_ = true;
        }
        woken_.notify_all();
    }

private:
    void run() {
        auto nextSweep = std::chrono::steady_clock::now() + kSweepEvery;
        for (;;) {
            {
                std::unique_lock lock(mutex_);
                woken_.wait_for(lock, std::chrono::milliseconds(200), [&] { return stopping_ || work_; });
                if (stopping_) return;
                work_ = false;
            }
            const bool sweep = std::chrono::steady_clock::now() >= nextSweep;
            if (sweep) nextSweep += kSweepEvery;
            step(sweep);
        }
    }
    void step(bool sweep) {
        try {
            scheduler_.expire();
            for (const std::string& fault : images_.finishFrames()) {
                spdlog::error("a frame cannot be finished: {}", fault);
                std::this_thread::sleep_for(std::chrono::seconds(1));  // a full disk: not in a tight circle
            }
            if (!sweep) return;
            const auto violations = scheduler_.sweep();
            metrics_.violations(violations.size());
            for (const Violation& v : violations) {
                spdlog::error("invariant {} broken at {}{}", v.invariant, v.detail,
                              v.repaired ? ", repaired" : "");
            }
        } catch (const std::exception& fault) {
            spdlog::error("housekeeping: {}", fault.what());
        }
    }

    Scheduler& scheduler_;
    FrameImages& images_;
    Metrics& metrics_;
    std::mutex mutex_;
    std::condition_variable woken_;
    bool stopping_ = false, work_ = true;
    std::thread thread_;
};

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
    FrameImages images(store, scheduler, films, clock, config.data);
    ResultMerger merger(store, scheduler, films);
    reportSweep(scheduler);
    removeLeftovers(store, films, images);

    Services services{config.api, clock, store, blobs, scheduler, merger, images, events, metrics};
    Housekeeper keeper(scheduler, images, metrics);  // outlives the server, whose requests wake it
    housekeeper = &keeper;
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
        spdlog::set_level(config.verbose ? spdlog::level::debug : spdlog::level::info);
        tilefarm::serve(config, stop);
        return 0;
    } catch (const std::exception& fault) {
        fmt::print(stderr, "tilefarm-server: {}\n", fault.what());
        return 1;
    }
}
