#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <ostream>

#include "server/cli/commands.h"
#include "shared/error/error.h"
#include "shared/image/exr.h"
#include "shared/image/metrics.h"
#include "shared/image/png.h"

namespace tilefarm {

namespace {

using nlohmann::json;

bool sameBits(const FloatImage& a, const FloatImage& b) {
    return a.width == b.width && a.height == b.height && a.channels == b.channels &&
           std::equal(a.planes.begin(), a.planes.end(), b.planes.begin(), [](const auto& p, const auto& q) {
               return std::memcmp(p.data(), q.data(), p.size() * sizeof(float)) == 0;
           });
}

json toJson(const ImagePair& pair, bool identical) {
    json result{{"identical", identical}};
    for (const ImageMetric& metric : imageMetrics())
        if (const auto value = metric.of(pair)) result[std::string(metric.name)] = *value;
    return result;
}

void print(const ImagePair& pair, bool identical, std::ostream& out) {
    for (const ImageMetric& metric : imageMetrics())
        if (const auto value = metric.of(pair)) out << fmt::format("{:<16} {:.6g}\n", metric.title, *value);
    out << fmt::format("{:<16} {}\n", "identical", identical ? "yes" : "no");
}

using Plane = std::vector<float>;

Plane mapped(Plane plane, auto&& change) {
    for (float& value : plane) value = change(value);
    return plane;
}

// What a PNG writer will encode as (n + 1) / 2, the way normal maps look.
float showNormal(float component) {
    const float display = std::clamp(component * 0.5f + 0.5f, 0.f, 1.f);
    return display <= 0.04045f ? display / 12.92f : std::pow((display + 0.055f) / 1.055f, 2.4f);
}

FloatImage picture(const FloatImage& image, Plane r, Plane g, Plane b) {
    return {image.width, image.height, {"R", "G", "B"}, {std::move(r), std::move(g), std::move(b)}};
}

FloatImage layerOf(const FloatImage& image, const std::string& name) {
    if (image.find(name + ".R") >= 0)
        return picture(image, image.plane(name + ".R"), image.plane(name + ".G"), image.plane(name + ".B"));
    if (image.find(name + ".X") >= 0)
        return picture(image, mapped(image.plane(name + ".X"), showNormal),
                       mapped(image.plane(name + ".Y"), showNormal),
                       mapped(image.plane(name + ".Z"), showNormal));
    Plane grey = image.plane(name);
    float largest = 0;
    for (const float value : grey)
        if (std::isfinite(value)) largest = std::max(largest, value);
    if (largest > 0) grey = mapped(std::move(grey), [&](float value) { return value / largest; });
    return picture(image, grey, grey, grey);
}

}  // namespace

int compare(const CompareOptions& options, const Console& console) {
    const FloatImage a = readExr(options.a), b = readExr(options.b);
    const bool identical = sameBits(a, b);
    const ImagePair pair(a, b, options.tone);
    if (options.json)
        console.out << toJson(pair, identical).dump(2) << '\n';
    else
        print(pair, identical, console.out);
    if (options.identical && !identical) {
        console.err << "the images are not identical\n";
        return kFailed;
    }
    if (options.maxRelMse && pair.difference.relMse > *options.maxRelMse) {
        console.err << fmt::format("relMSE {:.6g} is above {:.6g}\n", pair.difference.relMse,
                                   *options.maxRelMse);
        return kFailed;
    }
    return kDone;
}

int convertToPng(const std::filesystem::path& exr, const std::filesystem::path& png,
                 const std::string& channel, const ToneMapping& tone, const Console& console) {
    const FloatImage image = readExr(exr);
    // Layers but this one are data, not light: no curve bends them.
    if (channel.empty() || channel == "denoised")
        writePng(png, toneMapped(channel.empty() ? image : layerOf(image, channel), tone));
    else
        writePng(png, toneMapped(layerOf(image, channel), {ToneCurve::linear, tone.exposure}));
    console.err << fmt::format("wrote {}\n", png.string());
    return kDone;
}

}  // namespace tilefarm
