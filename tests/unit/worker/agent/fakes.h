#pragma once

#include <algorithm>
#include <deque>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/digest/digest.h"
#include "shared/image/exr.h"
#include "tests/support/fake_clock.h"
#include "worker/agent/actions.h"
#include "worker/agent/farm.h"
#include "worker/agent/pause.h"

namespace tilefarm {

/// Waits by moving a clock, and remembers how long.
struct FakePause : Pause {
    explicit FakePause(FakeClock& c) : clock(c) {}
    void waitFor(Milliseconds time) override {
        waits.push_back(time);
        clock.advance(time);
        if (onWait) onWait();
        if (waits.size() > 1000) stopped = true;  // a loop that never ends is a failure, not a hang
    }
    bool stopping() const override { return stopped; }

    FakeClock& clock;
    std::vector<Milliseconds> waits;
    std::function<void()> onWait;
    bool stopped = false;
};

/// A server in memory: grants the leases it was given in turn, takes results, and fails on request.
/// Any thread may call.
struct MemoryFarm : Farm {
    struct Upload {
        std::string leaseId;
        uint64_t epoch;
        std::vector<PassFilm> films;
        double deviceSeconds;
    };

    /// The next `times` calls of that endpoint fail with that code.
    void fail(Endpoint endpoint, ErrorCode code, int times = 1) {
        for (int i = 0; i < times; ++i) faults[endpoint].push_back(code);
    }
    std::string addBlob(const std::string& text) {
        const std::string sha256 = sha256Hex(text);
        blobs[sha256] = text;
        return sha256;
    }

    std::variant<Lease, NoWork> lease(const WorkerHello& hello, double) override {
        const std::lock_guard lock(mutex);
        called(Endpoint::lease);
        helloed = hello;
        if (leases.empty()) {
            if (onIdle) onIdle();
            return NoWork{retryAfterMs};
        }
        Lease granted = leases.front();
        leases.pop_front();
        return granted;
    }
    void getBlob(const std::string& sha256, const std::filesystem::path& file) override {
        const std::lock_guard lock(mutex);
        called(Endpoint::blob);
        if (!blobs.contains(sha256)) throw Error(ErrorCode::notFound, "there is no blob " + sha256);
        std::ofstream(file, std::ios::binary) << blobs[sha256];
    }
    void renew(const std::string& leaseId, uint64_t) override {
        const std::lock_guard lock(mutex);
        called(Endpoint::renew);
        renewed.push_back(leaseId);
    }
    ResultReceipt upload(const ResultUpload& result) override {
        const std::lock_guard lock(mutex);
        called(Endpoint::result);
        if (sha256Hex(result.exr) != result.sha256) throw Error(ErrorCode::unprocessable, "bad digest");
        uploads.push_back({result.leaseId, result.epoch, decodePassFilms(result.exr), result.deviceSeconds});
        return {static_cast<uint32_t>(uploads.back().films.size()), 0};
    }
    void handBack(const std::string& leaseId, uint64_t) override {
        const std::lock_guard lock(mutex);
        called(Endpoint::handBack);
        handedBack.push_back(leaseId);
    }
    void reportFailure(const std::string& leaseId, uint64_t, const std::string& message) override {
        const std::lock_guard lock(mutex);
        called(Endpoint::failure);
        failures.emplace_back(leaseId, message);
    }
    void reportScene(const std::string& leaseId, uint64_t, const PreparedScene& scene) override {
        const std::lock_guard lock(mutex);
        called(Endpoint::report);
        reports.emplace_back(leaseId, scene);
    }

    std::mutex mutex;
    std::deque<Lease> leases;
    std::map<std::string, std::string> blobs;
    std::map<Endpoint, std::deque<ErrorCode>> faults;
    std::map<Endpoint, int> calls;
    WorkerHello helloed;
    uint32_t retryAfterMs = 1000;
    std::vector<std::string> renewed, handedBack;
    std::vector<Upload> uploads;
    std::vector<std::pair<std::string, std::string>> failures;
    std::vector<std::pair<std::string, PreparedScene>> reports;
    std::function<void()> onIdle;

private:
    void called(Endpoint endpoint) {
        ++calls[endpoint];
        auto& due = faults[endpoint];
        if (due.empty()) return;
        const ErrorCode code = due.front();
        due.pop_front();
        throw Error(code, "the server says no to " + std::string(toString(endpoint)));
    }
};

/// Hands every call to one MemoryFarm, so that each thread of a worker can own a Farm.
struct SharedFarm : Farm {
    explicit SharedFarm(MemoryFarm& f) : farm(f) {}
    std::variant<Lease, NoWork> lease(const WorkerHello& h, double w) override { return farm.lease(h, w); }
    void getBlob(const std::string& s, const std::filesystem::path& f) override { farm.getBlob(s, f); }
    void renew(const std::string& l, uint64_t e) override { farm.renew(l, e); }
    ResultReceipt upload(const ResultUpload& r) override { return farm.upload(r); }
    void handBack(const std::string& l, uint64_t e) override { farm.handBack(l, e); }
    void reportFailure(const std::string& l, uint64_t e, const std::string& m) override {
        farm.reportFailure(l, e, m);
    }
    void reportScene(const std::string& l, uint64_t e, const PreparedScene& s) override {
        farm.reportScene(l, e, s);
    }
    MemoryFarm& farm;
};

/// What a pixel of the fake device is: known to tests, different for each pixel and sample range.
inline PassPixel fakePixel(const Rect& rect, uint32_t index, SampleRange samples) {
    const uint32_t x = rect.x + index % rect.width, y = rect.y + index / rect.width;
    const float value = 0.25f * static_cast<float>(x + 3 * y) + 0.001f * static_cast<float>(samples.first);
    PassPixel pixel;
    pixel.mean = {value, value / 2, value / 4};
    pixel.count = static_cast<float>(samples.count);
    pixel.m2 = {0.5f * static_cast<float>(samples.count - 1), 0, 0};
    pixel.m2Luminance = 0.1f * static_cast<float>(samples.count - 1);
    pixel.alpha = 1;
    return pixel;
}

/// A device without one: a film is a function of tile and samples, as it is on a real one. Takes a
/// hundredth of a device-second for each pass.
struct FakeBackend : RenderBackend {
    struct Call {
        std::vector<uint32_t> tiles;
        SampleRange samples;
        friend bool operator==(const Call&, const Call&) = default;
    };

    DeviceName device() const override { return {"Fake", "fake 1.0"}; }
    PreparedScene prepare(const JobSpec& spec, const SceneFiles& files) override {
        prepared.push_back(spec.scene.entry);
        const std::ifstream file(files.entry);
        if (!file) throw Error(ErrorCode::notFound, "cannot open " + files.entry.string());
        if (!prepareFault.empty())
            throw Error(ErrorCode::invalidArgument, files.entry.string() + prepareFault);
        image = spec.image;
        total = {};
        PreparedScene scene;
        scene.counts.triangles = 12;
        scene.warnings = {{"KHR_x", "materials/0", "left out"}};
        scene.features = {{"diffuse"}, {"glass"}, {}};
        return scene;
    }
    std::vector<PassFilm> render(int32_t, std::span<const uint32_t> tiles, SampleRange samples) override {
        calls.push_back({{tiles.begin(), tiles.end()}, samples});
        if (onRender) onRender();
        std::vector<PassFilm> films;
        for (const uint32_t tile : tiles) {
            PassFilm film{tile, TileGrid(image).rect(tile), samples, {}};
            for (uint32_t i = 0; i < film.rect.area(); ++i)
                film.pixels.push_back(fakePixel(film.rect, i, samples));
            total.samples += film.rect.area() * samples.count;
            total.rays += 3 * film.rect.area() * samples.count;
            total.deviceSeconds += 0.01;
            films.push_back(std::move(film));
        }
        return films;
    }
    RenderStats stats() const override { return total; }
    void drop() override { ++drops; }
    void reset() override { ++resets; }

    std::string prepareFault;
    std::function<void()> onRender;
    std::vector<std::string> prepared;
    std::vector<Call> calls;
    ImageSpec image;
    RenderStats total;
    int drops = 0, resets = 0;
};

/// A lease of a job of 16 x 8 pixels in two tiles, its scene one blob of that farm.
inline Lease fakeLease(MemoryFarm& farm, const std::string& id, const std::string& job = "job1") {
    Lease lease;
    lease.id = id;
    lease.epoch = 5;
    lease.jobId = job;
    lease.spec.scene.entry = "scene.gltf";
    lease.spec.scene.files = {{"scene.gltf", farm.addBlob("{\"scene of\": \"" + job + "\"}")}};
    lease.spec.image = {16, 8, 8};
    lease.passes = {{0, {0, 1}}, {1, {0, 1}}, {0, {1, 1}}, {1, {1, 1}}, {0, {2, 2}}};
    return lease;
}

}  // namespace tilefarm
