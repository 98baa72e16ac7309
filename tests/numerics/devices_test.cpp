// Case 45 across devices: at equal seeds two devices render the same picture but for paths that part where a
// rounding differs.
//
// With several drivers in VK_DRIVER_FILES the first test compares them with one another. The second compares
// each with pictures that one device left in tests/data, so that a machine without a GPU compares with one
// too. TILEFARM_CASE_45_WRITE=<folder> has the first device write such pictures there instead.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "shared/image/exr.h"
#include "tests/numerics/picture.h"
#include "worker/scene/load.h"
#include "worker/vk/device.h"

namespace tilefarm {
namespace {

namespace fs = std::filesystem;

/// Where the sources are: tests that were built elsewhere are run from a copy of the repository.
fs::path dataFolder() {
    const fs::path built = fs::path(TILEFARM_SOURCE_DIR) / "tests/data";
    return fs::exists(built) ? built : fs::current_path() / "tests/data";
}

struct NamedScene {
    const char* name;
    const char* file;
    const char* environment;
    uint32_t maxBounces;
};
constexpr NamedScene kScenes[]{
    {"cornell", "cornell.gltf", "", 5},            // diffuse, a lamp
    {"demo", "demo/demo.glb", "demo/sky.hdr", 8},  // glass, metals, textures, a sky
    {"layers", "layers.glb", "demo/sky.hdr", 8},   // coats, sheens, films
};
const Shot kStored{.size = 64, .samples = 64};

Picture renderOn(const gpu::Device& device, const NamedScene& named, Shot shot) {
    Scene scene = loadGltf(dataFolder() / named.file);
    if (*named.environment) loadEnvironment(scene, dataFolder() / named.environment);
    lightIfDark(scene);
    shot.maxBounces = named.maxBounces;
    return render(device, scene, selectCamera(scene, "auto", 1), shot);
}

/// Means of red, green and blue of each pixel with the variances of these means.
struct Estimate {
    std::string device;
    std::vector<double> mean, variance;
};

Estimate estimateOf(const gpu::Device& device, const NamedScene& named, const Shot& shot) {
    Estimate estimate{fmt::format("{}, {}", device.info().name, device.info().driver), {}, {}};
    const Picture picture = renderOn(device, named, shot);
    EXPECT_TRUE(allFinite(picture)) << named.name << " on " << estimate.device;
    EXPECT_EQ(picture.stats.droppedSamples, 0u) << named.name << " on " << estimate.device;
    for (const FilmPixel& pixel : picture.pixels)
        for (int c = 0; c < 3; ++c) {
            estimate.mean.push_back(pixel.mean[static_cast<size_t>(c)]);
            estimate.variance.push_back(pixel.varianceOfMean(c));
        }
    return estimate;
}

// As the case has it: the z-test in 99.75 % of the pixels, and a difference no larger than that of two
// renders with seeds of their own. z is 3 here, where 0.27 % of right pixels would fail if nothing but chance
// bound the two together.
void expectAgreement(const Estimate& a, const Estimate& b, const std::string& scene) {
    SCOPED_TRACE(fmt::format("{}: {} against {}", scene, a.device, b.device));
    ASSERT_EQ(a.mean.size(), b.mean.size());
    const size_t pixels = b.mean.size() / 3;
    double passing = 0, same = 0, difference = 0, variance = 0, square = 0;
    for (size_t p = 0; p < pixels; ++p) {
        bool passes = true, equal = true;
        for (size_t i = 3 * p; i < 3 * p + 3; ++i) {
            const double off = std::abs(a.mean[i] - b.mean[i]),
                         sigma = std::sqrt(a.variance[i] + b.variance[i]);
            passes = passes && off <= 3 * sigma + 1e-5 * std::abs(b.mean[i]);
            equal = equal && off <= 1e-6 * std::abs(b.mean[i]);
            difference += off * off;
            variance += b.variance[i];
            square += b.mean[i] * b.mean[i] + 1e-4;
        }
        passing += passes;
        same += equal;
    }
    const auto share = [&](double count) { return 100 * count / static_cast<double>(pixels); };
    fmt::print(
        "{}, {} against {}: {:.3f} % of the pixels pass, {:.1f} % are equal to 1e-6; relMSE of the "
        "difference "
        "{:.3g}, estimated of one render {:.3g}\n",
        scene, a.device, b.device, share(passing), share(same), difference / square, variance / square);
    recordWorst(scene + "_failing_percent", 100 - share(passing));
    recordWorst(scene + "_relmse_of_expected", difference / variance);
    EXPECT_GE(share(passing), 99.75);
    EXPECT_LE(difference / square, 2 * variance / square);
    EXPECT_GT(variance, 0) << "a picture without noise compares nothing";
}

std::vector<uint32_t> usableDevices() {
    std::vector<uint32_t> usable;
    for (const gpu::DeviceInfo& info : gpu::listDevices())
        if (info.usable) usable.push_back(info.index);
    return usable;
}

void expectDevicesAgree(const Shot& shot) {
    const std::vector<uint32_t> devices = usableDevices();
    if (devices.size() < 2)
        GTEST_SKIP() << "one device; name the manifests of several drivers in VK_DRIVER_FILES";
    for (const NamedScene& scene : kScenes) {
        std::vector<Estimate> estimates;
        for (const uint32_t index : devices) estimates.push_back(estimateOf(gpu::Device(index), scene, shot));
        for (size_t b = 1; b < estimates.size(); ++b)
            for (size_t a = 0; a < b; ++a) expectAgreement(estimates[a], estimates[b], scene.name);
    }
}

TEST(HardDevices, HardCase45_DevicesAgree) {
    expectDevicesAgree(kStored);
}
TEST(HardDevices, FullHardCase45_DevicesAgree) {
    expectDevicesAgree({.size = 128, .samples = 256});
}

// ---- Pictures that were stored

constexpr const char* kChannels[]{"R", "G", "B", "variance.R", "variance.G", "variance.B"};

fs::path fileOf(const fs::path& folder, const NamedScene& scene) {
    return folder / fmt::format("hard_case_45_{}.exr", scene.name);
}

void store(const fs::path& file, const Estimate& estimate, const NamedScene& scene) {
    FloatImage image{kStored.size, kStored.size, {std::begin(kChannels), std::end(kChannels)}, {}};
    for (size_t c = 0; c < 6; ++c) {
        const std::vector<double>& from = c < 3 ? estimate.mean : estimate.variance;
        std::vector<float>& plane = image.planes.emplace_back();
        for (size_t i = c % 3; i < from.size(); i += 3) plane.push_back(static_cast<float>(from[i]));
    }
    writeExr(file, image,
             {{"device", estimate.device},
              {"scene", scene.file},
              {"samples", fmt::to_string(kStored.samples)},
              {"seed", fmt::to_string(kStored.seed)},
              {"maxBounces", fmt::to_string(scene.maxBounces)}});
}

Estimate stored(const fs::path& file) {
    const FloatImage image = readExr(file);
    Estimate estimate{"stored of " + readExrAttributes(file).at("device"), {}, {}};
    for (size_t i = 0; i < image.pixelCount(); ++i)
        for (size_t c = 0; c < 3; ++c) {
            estimate.mean.push_back(double{image.plane(kChannels[c])[i]});
            estimate.variance.push_back(double{image.plane(kChannels[c + 3])[i]});
        }
    return estimate;
}

TEST(HardDevices, HardCase45_StoredPicturesAgree) {
    const char* write = std::getenv("TILEFARM_CASE_45_WRITE");
    if (!write && !fs::exists(fileOf(dataFolder(), kScenes[0]))) GTEST_SKIP() << "no picture is stored";
    for (const uint32_t index : usableDevices()) {
        const gpu::Device device(index);
        for (const NamedScene& scene : kScenes) {
            const Estimate here = estimateOf(device, scene, kStored);
            if (write)
                store(fileOf(write, scene), here, scene);
            else
                expectAgreement(here, stored(fileOf(dataFolder(), scene)), scene.name);
        }
        if (write) break;
    }
}

}  // namespace
}  // namespace tilefarm
