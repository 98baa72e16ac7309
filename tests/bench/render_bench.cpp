// Times the renderer beside a path tracer over Embree on the same machine and in the same run.
//
//     tilefarm_bench [--device N] [--repeats 5] [--seconds 2] [--only cornell,terrain,…] [--json out.json]
//     tilefarm_bench --write-terrain terrain.glb      for other programs, as compare_cycles.py uses it
//
// On the Lambert scenes both follow the same estimator, so that rays per second compare like with like; their
// mean radiances are compared too, since a wrong image is easily fast. Measurements of the two alternate, and
// of the repeats the median counts: on a shared machine neighbouring minutes differ more than programs do.
// The shared scenes have materials that the host path tracer does not know: only the renderer is timed there.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <thread>

#include "shared/error/error.h"
#include "tests/bench/bench_glb.h"
#include "tests/bench/bench_scenes.h"
#include "tests/bench/embree_path_tracer.h"
#include "worker/render/renderer.h"
#include "worker/scene/load.h"
#include "worker/vk/device.h"

namespace tilefarm::bench {
namespace {

namespace fs = std::filesystem;

struct Case {
    std::string name;
    std::function<Scene()> load;
    uint32_t width, height, maxBounces;
    bool lambert;  // the host path tracer can follow
};

struct Options {
    uint32_t device = 0;
    uint32_t repeats = 5;
    double seconds = 2;
    std::vector<std::string> only;
    std::string json;
    std::string writeTerrain;
};

constexpr uint32_t kTerrainSide = 707;  // 1.0 million triangles

/// Rates of one program on one case.
struct Rates {
    double raysPerSecond = 0, samplesPerSecond = 0, meanRadiance = 0, prepareSeconds = 0;
};

struct Result {
    std::string name;
    uint64_t triangles = 0;
    Rates ours;
    std::optional<Rates> embree;
    double rayRatio() const { return ours.raysPerSecond / embree->raysPerSecond; }
};

double secondsOf(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const size_t middle = values.size() / 2;
    return values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

/// Drives the renderer over whole frames, sample range after sample range.
class RendererUnderTest {
public:
    RendererUnderTest(const gpu::Device& device, const Scene& scene, const Camera& camera,
                      const ImageSpec& image, const RenderSettings& settings)
        : renderer_(device, scene, camera, image, settings), tiles_(TileGrid(image).count()) {
        std::iota(tiles_.begin(), tiles_.end(), 0u);
    }

    void render(uint32_t samples) {
        // As long as the longest pass of a job's schedule, so that the benchmark dispatches as a worker does.
        for (uint32_t left = samples; left > 0;) {
            const uint32_t count = std::min(left, kMaxPassSamples);
            for (const PassFilm& film : renderer_.render(0, tiles_, {done_, count})) add(film);
            done_ += count;
            left -= count;
        }
    }

    const RenderStats& stats() const { return renderer_.stats(); }
    uint64_t triangles() const { return renderer_.triangleCount(); }
    const PrepareTimes& prepareTimes() const { return renderer_.prepareTimes(); }
    double meanRadiance() const { return sum_ / (3 * count_); }

private:
    void add(const PassFilm& film) {
        for (const PassPixel& pixel : film.pixels) {
            sum_ += double(pixel.count) * (double(pixel.mean[0]) + pixel.mean[1] + pixel.mean[2]);
            count_ += pixel.count;
        }
    }

    Renderer renderer_;
    std::vector<uint32_t> tiles_;
    uint32_t done_ = 0;
    double sum_ = 0, count_ = 0;
};

/// One timed run of either program: rays and samples per second of wall time.
template <typename Program>
void measure(Program& program, uint32_t samples, std::vector<double>& rays, std::vector<double>& paths) {
    const auto before = program.stats();
    const double seconds = secondsOf([&] { program.render(samples); });
    rays.push_back(double(program.stats().rays - before.rays) / seconds);
    paths.push_back(double(program.stats().samples - before.samples) / seconds);
}

/// Samples per pixel that take about `seconds`; the first call also warms up (kernels compile lazily).
template <typename Program>
uint32_t samplesFor(Program& program, double seconds) {
    program.render(1);
    const double one = secondsOf([&] { program.render(1); });
    return std::clamp(uint32_t(seconds / std::max(one, 1e-6)), 1u, 4096u);
}

Result runCase(const Case& c, const gpu::Device& device, const Options& options) {
    const Scene scene = c.load();
    const Camera camera = selectCamera(scene, "auto", double(c.width) / c.height);
    ImageSpec image;
    image.width = c.width;
    image.height = c.height;
    RenderSettings settings;
    settings.maxBounces = c.maxBounces;
    settings.rouletteStart = c.maxBounces;  // none: as the host path tracer

    Result result;
    result.name = c.name;
    std::optional<RendererUnderTest> ours;
    result.ours.prepareSeconds = secondsOf([&] { ours.emplace(device, scene, camera, image, settings); });
    result.triangles = ours->triangles();
    std::optional<EmbreePathTracer> embree;
    if (c.lambert) embree.emplace(scene, camera, image, settings);

    const uint32_t ourSamples = samplesFor(*ours, options.seconds);
    const uint32_t hostSamples = embree ? samplesFor(*embree, options.seconds) : 0;
    std::vector<double> ourRays, ourPaths, hostRays, hostPaths;
    for (uint32_t repeat = 0; repeat < options.repeats; ++repeat) {
        measure(*ours, ourSamples, ourRays, ourPaths);
        if (embree) measure(*embree, hostSamples, hostRays, hostPaths);
    }
    result.ours.raysPerSecond = median(ourRays);
    result.ours.samplesPerSecond = median(ourPaths);
    result.ours.meanRadiance = ours->meanRadiance();
    if (embree)
        result.embree =
            Rates{median(hostRays), median(hostPaths), embree->meanRadiance(), embree->buildSeconds()};
    return result;
}

std::vector<Case> allCases() {
    const fs::path source = TILEFARM_SOURCE_DIR;
    std::vector<Case> cases{
        {"cornell",
         [=] {
             Scene scene = loadGltf(source / "tests/data/cornell.gltf");
             makeLambert(scene);
             return scene;
         },
         512, 512, 5, true},
        {"terrain", [] { return terrainRoom(kTerrainSide); }, 512, 512, 5, true},
    };
    const fs::path shared = source.parent_path() / "shared";
    const auto add = [&](const std::string& name, const char* file, const char* environment,
                         uint32_t bounces) {
        const fs::path path = shared / "scenes" / file;
        if (!fs::exists(path)) return;
        cases.push_back({name,
                         [=] {
                             Scene scene = loadGltf(path);
                             if (*environment) loadEnvironment(scene, shared / "environments" / environment);
                             return scene;
                         },
                         640, 360, bounces, false});
    };
    cases.push_back({"demo",
                     [=] {
                         Scene scene = loadGltf(source / "tests/data/demo/demo.glb");
                         loadEnvironment(scene, source / "tests/data/demo/sky.hdr");
                         return scene;
                     },
                     640, 360, 8, false});
    add("damaged-helmet", "damaged-helmet/DamagedHelmet.glb", "chinese_garden_1k.hdr", 5);
    add("bathroom", "bathroom/LAZIENKA.gltf", "", 8);
    add("chinese-dragon", "chinese-dragon/chinesedragon.gltf", "brown_photostudio_02_1k.hdr", 5);
    return cases;
}

void print(const Result& r) {
    fmt::print("{:<16}{:>10}{:>12.2f}{:>12.0f}", r.name, r.triangles, r.ours.raysPerSecond / 1e6,
               r.ours.samplesPerSecond / 1e3);
    if (r.embree)
        fmt::print("{:>12.2f}{:>12.0f}{:>8.2f}{:>12.4f}{:>10.4f}", r.embree->raysPerSecond / 1e6,
                   r.embree->samplesPerSecond / 1e3, r.rayRatio(), r.ours.meanRadiance,
                   r.embree->meanRadiance);
    fmt::print("\n");
    std::fflush(stdout);
}

nlohmann::json toJson(const Rates& r) {
    return {{"raysPerSecond", r.raysPerSecond},
            {"samplesPerSecond", r.samplesPerSecond},
            {"meanRadiance", r.meanRadiance},
            {"prepareSeconds", r.prepareSeconds}};
}

nlohmann::json toJson(const Result& r) {
    nlohmann::json json{{"name", r.name}, {"triangles", r.triangles}, {"tilefarm", toJson(r.ours)}};
    if (r.embree) {
        json["embree"] = toJson(*r.embree);
        json["rayRatio"] = r.rayRatio();
        json["sampleRatio"] = r.ours.samplesPerSecond / r.embree->samplesPerSecond;
    }
    return json;
}

/// Both programs estimate the same integral; a per cent apart is far more than noise over this many samples.
bool sameImage(const Result& r) {
    return !r.embree || std::abs(r.ours.meanRadiance / r.embree->meanRadiance - 1) < 0.01;
}

int run(const Options& options) {
    const gpu::Device device(options.device);
    const auto& info = device.info();
    fmt::print("{} ({}), {} host threads; wall time, median of {} repeats of about {} s\n\n", info.name,
               info.driver, std::thread::hardware_concurrency(), options.repeats, options.seconds);
    fmt::print("{:<16}{:>10}{:>12}{:>12}{:>12}{:>12}{:>8}{:>12}{:>10}\n", "scene", "triangles", "Mrays/s",
               "ksamples/s", "Embree Mr/s", "Embree ks/s", "ratio", "mean", "Embree's");
    nlohmann::json results = nlohmann::json::array();
    bool same = true;
    for (const Case& c : allCases()) {
        if (!options.only.empty() &&
            std::find(options.only.begin(), options.only.end(), c.name) == options.only.end())
            continue;
        const Result result = runCase(c, device, options);
        print(result);
        same = same && sameImage(result);
        results.push_back(toJson(result));
    }
    if (!options.json.empty())
        std::ofstream(options.json) << nlohmann::json{{"device", info.name},
                                                      {"driver", info.driver},
                                                      {"hostThreads", std::thread::hardware_concurrency()},
                                                      {"repeats", options.repeats},
                                                      {"results", results}}
                                           .dump(2)
                                    << '\n';
    if (!same) fmt::print(stderr, "tilefarm_bench: mean radiances differ by more than 1 %\n");
    return same ? 0 : 1;
}

}  // namespace
}  // namespace tilefarm::bench

int main(int argc, char** argv) {
    tilefarm::bench::Options options;
    CLI::App app{"Times the renderer beside a path tracer over Embree"};
    try {
        app.add_option("--device", options.device, "as `tilefarm-worker devices` counts")
            ->capture_default_str();
        app.add_option("--repeats", options.repeats, "timed runs of each program")
            ->check(CLI::Range(1, 1000));
        app.add_option("--seconds", options.seconds, "about how long a timed run takes")
            ->check(CLI::PositiveNumber);
        app.add_option("--only", options.only, "cases to run, comma separated")->delimiter(',');
        app.add_option("--json", options.json, "file for the results");
        app.add_option("--write-terrain", options.writeTerrain, "only write the terrain scene to this .glb");
        CLI11_PARSE(app, argc, argv);
        if (!options.writeTerrain.empty()) {
            tilefarm::bench::writeGlb(tilefarm::bench::terrainRoom(tilefarm::bench::kTerrainSide),
                                      options.writeTerrain);
            return 0;
        }
        if (app.count("--device") == 0) options.device = tilefarm::gpu::defaultDevice();
        return tilefarm::bench::run(options);
    } catch (const std::exception& error) {
        fmt::print(stderr, "tilefarm_bench: {}\n", error.what());
        return 1;
    }
}
