// Rays per second of the traversal kernel against Embree's rtcIntersect1 on two threads of the host, on the
// same rays: camera rays and four diffuse bounces in a Cornell box and over a terrain of a million triangles.
//
// Both take turns, ray set by ray set, and the best of the repeats counts: other work on the machine then
// disturbs both alike. On a software device processor seconds are compared, which such work disturbs least;
// on a GPU device seconds against Embree's wall clock.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <limits>

#include "shared/error/error.h"
#include "tests/support/embree_oracle.h"
#include "tests/support/trace_kernel.h"

namespace tilefarm {
namespace {

constexpr int kBounces = 4;
constexpr unsigned kThreads = 2;
constexpr int kGpuTurns = 200;

struct Settings {
    uint32_t device = std::numeric_limits<uint32_t>::max();
    uint32_t size = 256;
    uint32_t cells = 708;
    int repeats = 5;
    bool wall = false;
    std::string kernel;  // file of another SPIR-V build of trace_rays.comp
};

double secondsOf(clockid_t clock) {
    timespec time;
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Where the rays hit, one diffuse ray onwards each.
std::vector<TestRay> bounce(const Triangles& triangles, std::span<const TestRay> rays,
                            std::span<const OracleHit> hits, uint64_t seed) {
    RandomNumbers random(seed);
    std::vector<TestRay> onwards;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].primitive == kMissed) continue;
        const glm::vec3* corner = &triangles[3 * size_t(hits[i].primitive)];
        glm::vec3 normal = glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
        if (glm::dot(normal, rays[i].direction) > 0) normal = -normal;
        TestRay ray;
        ray.origin = rays[i].origin + hits[i].t * rays[i].direction + 1e-5f * normal;
        ray.direction = glm::normalize(1.0001f * normal + random.direction());
        onwards.push_back(ray);
    }
    return onwards;
}

std::vector<uint32_t> spirvFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    if (bytes.empty()) throw Error(ErrorCode::notFound, fmt::format("Cannot read {}", path));
    std::vector<uint32_t> words(bytes.size() / 4);
    std::memcpy(words.data(), bytes.data(), words.size() * 4);
    return words;
}

// Rays that Embree and the kernel find different surfaces for. A few are on edges.
size_t disagreements(std::span<const OracleHit> theirs, std::span<const TracedHit> ours) {
    size_t count = 0;
    for (size_t i = 0; i < ours.size(); ++i) {
        const bool bothMiss = ours[i].missed() && theirs[i].primitive == kMissed;
        const bool bothHit = !ours[i].missed() && theirs[i].primitive != kMissed;
        count += !bothMiss && !(bothHit && std::abs(ours[i].t - theirs[i].t) <= 1e-5f * (1 + theirs[i].t));
    }
    return count;
}

void runScene(const char* name, const gpu::Device& device, const Settings& settings,
              const Triangles& triangles, const std::vector<TestRay>& camera) {
    const EmbreeOracle embree(triangles, false);  // rtcIntersect1 at its default, faster than its robust mode
    const std::vector<uint32_t> spirv =
        settings.kernel.empty() ? std::vector<uint32_t>{} : spirvFile(settings.kernel);
    TraceKernel kernel(device, triangles, {.spirv = spirv});
    const bool processorTime = device.info().cpu && !settings.wall;
    const clockid_t clock = processorTime ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;

    fmt::print("{}: {} triangles, {} nodes, stack {}\n", name, triangles.size() / 3, kernel.bvh().nodeCount,
               kernel.bvh().stackSize);
    std::vector<TestRay> rays = camera;
    double embreeSum = 0, kernelSum = 0, count = 0;
    size_t different = 0;
    kernel.trace(rays);  // compiles
    for (int set = 0; set <= kBounces; ++set) {
        double embreeBest = std::numeric_limits<double>::infinity(), kernelBest = embreeBest;
        std::vector<OracleHit> theirs;
        for (int repeat = 0; repeat < settings.repeats; ++repeat) {
            double start = secondsOf(clock);
            theirs = embree.closest(rays, kThreads);
            embreeBest = std::min(embreeBest, secondsOf(clock) - start);
            // A GPU slows its clock down while Embree has its turn, and takes a while to speed up again.
            const auto ours = kernel.trace(rays, device.info().cpu ? 1 : kGpuTurns);
            kernelBest = std::min(kernelBest, processorTime ? kernel.processorSeconds() : kernel.seconds());
            if (repeat == 0) different += disagreements(theirs, ours);
        }
        const double number = static_cast<double>(rays.size());
        fmt::print("  {:8} {:8} rays  Embree {:7.2f}  kernel {:8.2f} Mrays/s  ratio {:.3f}\n",
                   set == 0 ? "camera" : fmt::format("bounce {}", set), rays.size(),
                   number / embreeBest * 1e-6, number / kernelBest * 1e-6, embreeBest / kernelBest);
        embreeSum += embreeBest, kernelSum += kernelBest, count += number;
        rays = bounce(triangles, rays, theirs, static_cast<uint64_t>(set) + 1);
    }
    fmt::print("  all      {:8} rays  Embree {:7.2f}  kernel {:8.2f} Mrays/s  ratio {:.3f}  ({} differ)\n",
               static_cast<size_t>(count), count / embreeSum * 1e-6, count / kernelSum * 1e-6,
               embreeSum / kernelSum, different);
}

int run(int argc, char** argv) {
    Settings settings;
    CLI::App app("Traversal kernel against Embree");
    app.add_option("--device", settings.device, "Vulkan device (default: the first that is usable)");
    app.add_option("--size", settings.size, "camera rays per side");
    app.add_option("--cells", settings.cells, "terrain cells per side, two triangles each");
    app.add_option("--repeats", settings.repeats);
    app.add_flag("--wall", settings.wall, "compare the wall clock on software devices too");
    app.add_option("--kernel", settings.kernel, "SPIR-V file to run instead of the built-in trace_rays.comp");
    CLI11_PARSE(app, argc, argv);
    if (settings.device == std::numeric_limits<uint32_t>::max()) settings.device = gpu::defaultDevice();
    const gpu::Device device(settings.device);
    fmt::print("{} ({}); Embree on {} threads, {}\n", device.info().name, device.info().driver, kThreads,
               device.info().cpu && !settings.wall ? "processor seconds" : "wall clock");
    runScene("Cornell box", device, settings, cornellBox(),
             cameraRays({0, 0, 3.3f}, {0, 0, 0}, 0.42f, settings.size, settings.size));
    runScene("Terrain", device, settings, terrain(settings.cells),
             cameraRays({0, 0.3f, 0.95f}, {0, -0.35f, 0}, 0.8f, settings.size, settings.size));
    return 0;
}

}  // namespace
}  // namespace tilefarm

int main(int argc, char** argv) {
    try {
        return tilefarm::run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
}
