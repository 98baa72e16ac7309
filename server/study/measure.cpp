#include "server/study/measure.h"

#include <cmath>
#include <map>

#include "server/study/pictures.h"
#include "shared/image/metrics.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr uint32_t kThumbnail = 280;  // pixels

// Of the mean over R, G and B of a picture.
double varianceOfMean(const FloatImage& image) {
    const auto count = static_cast<double>(3 * image.pixelCount());
    double sum = 0;
    for (size_t c = 0; c < image.channels.size(); ++c) {
        if (!image.channels[c].starts_with("variance.")) continue;
        for (const float variance : image.planes[c]) sum += variance;
    }
    return sum / (count * count);
}

// One seed's value of every metric, or nothing.
using SeedValues = std::map<std::string, std::vector<double>>;

void addMetrics(SeedValues& values, const FloatImage& image, const FloatImage& reference) {
    const ImagePair pair(image, reference);
    for (const ImageMetric& metric : imageMetrics())
        if (const auto value = metric.of(pair)) values[std::string(metric.name)].push_back(*value);
}

json biasOf(const SeedValues& values, const FloatImage& reference) {
    const Estimate bias = estimateOf(values.at("meanDifference"));
    const double of = values.at("meanReference").front();
    json view = toJson(bias);
    view["percent"] = of == 0 ? json() : json(100 * bias.value / of);
    view["z"] = zOf(bias, varianceOfMean(reference));
    return view;
}

}  // namespace

json toJson(const std::optional<Estimate>& estimate) {
    if (!estimate) return {};
    return {{"value", estimate->value}, {"low", estimate->low}, {"high", estimate->high}};
}

MeasuredCell measureCell(const FloatImage& reference, std::span<const double> seconds,
                         const std::function<FloatImage(size_t seed)>& picture) {
    MeasuredCell cell;
    SeedValues values;
    SeedSpread spread(reference, SeedSpread::Weight::relative);
    for (size_t seed = 0; seed < seconds.size(); ++seed) {
        const FloatImage image = picture(seed);
        addMetrics(values, image, reference);
        spread.add(image);
        if (seed > 0) continue;
        cell.pictures = {{"picture", pngUrl(image, kThumbnail)},
                         {"difference", pngUrl(differencePicture(image, reference), kThumbnail)}};
    }
    std::vector<double> errors = values.at("relMse"), efficiencies;
    for (size_t seed = 0; seed < errors.size(); ++seed) {
        errors[seed] -= spread.referenceVariance();
        efficiencies.push_back(1 / (errors[seed] * seconds[seed]));
    }
    json metrics;
    for (const auto& [name, ofSeeds] : values) metrics[name] = toJson(estimateOf(ofSeeds));
    cell.result = {{"deviceSeconds", toJson(estimateOf(seconds))},
                   {"mse", toJson(estimateOf(errors))},
                   {"variance", spread.variance()},
                   {"squaredBias", spread.squaredBias()},
                   {"referenceVariance", spread.referenceVariance()},
                   {"bias", biasOf(values, reference)},
                   {"efficiency", toJson(geometricEstimate(efficiencies))},
                   {"metrics", metrics},
                   {"perSeed", {{"mse", errors}, {"deviceSeconds", seconds}}}};
    return cell;
}

}  // namespace tilefarm
