#include "server/study/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

constexpr std::array kChannels{"R", "G", "B"};
constexpr double kDark = 0.01;  // as in relMSE: shared/image/metrics.cpp

double mean(std::span<const double> values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

}  // namespace

double studentQuantile(size_t freedom) {
    static constexpr std::array kQuantiles{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365,
                                           2.306,  2.262, 2.228, 2.201, 2.179, 2.160, 2.145,
                                           2.131,  2.120, 2.110, 2.101, 2.093, 2.086};
    if (freedom == 0) throw Error(ErrorCode::invalidArgument, "Student's t needs a degree of freedom");
    if (freedom <= kQuantiles.size()) return kQuantiles[freedom - 1];
    const double z = 1.959964, n = static_cast<double>(freedom);  // Cornish and Fisher's series
    return z + (z * z * z + z) / (4 * n) + (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / (96 * n * n);
}

Estimate estimateOf(std::span<const double> values) {
    if (values.empty()) throw Error(ErrorCode::invalidArgument, "a mean needs a value");
    Estimate estimate;
    estimate.value = mean(values);
    estimate.low = estimate.high = estimate.value;
    if (values.size() < 2) return estimate;
    double squares = 0;
    for (const double value : values) squares += (value - estimate.value) * (value - estimate.value);
    const auto count = static_cast<double>(values.size());
    estimate.standardError = std::sqrt(squares / (count - 1) / count);
    const double reach = studentQuantile(values.size() - 1) * estimate.standardError;
    estimate.low -= reach;
    estimate.high += reach;
    return estimate;
}

std::optional<Estimate> geometricEstimate(std::span<const double> values) {
    std::vector<double> logarithms;
    for (const double value : values) {
        if (!(value > 0) || !std::isfinite(value)) return {};
        logarithms.push_back(std::log(value));
    }
    const Estimate of = estimateOf(logarithms);
    const double value = std::exp(of.value);
    return Estimate{value, value * of.standardError, std::exp(of.low), std::exp(of.high)};
}

double zOf(const Estimate& mean, double referenceVariance) {
    const double variance = mean.standardError * mean.standardError + referenceVariance;
    return variance > 0 ? mean.value / std::sqrt(variance) : 0;
}

SeedSpread::SeedSpread(const FloatImage& reference, Weight weight) : reference_(reference), weight_(weight) {
    const auto count = static_cast<double>(kChannels.size() * reference.pixelCount());
    for (const char* channel : kChannels) {
        means_.emplace_back(reference.pixelCount(), 0.0);
        if (reference.find(std::string("variance.") + channel) < 0) continue;
        const auto& variances = reference.plane(std::string("variance.") + channel);
        const auto& values = reference.plane(channel);
        for (size_t i = 0; i < values.size(); ++i)
            referenceVariance_ += weightOf(values[i]) * variances[i] / count;
    }
}

double SeedSpread::weightOf(double reference) const {
    return weight_ == Weight::plain ? 1 : 1 / (reference * reference + kDark * kDark);
}

// Welford's update of every value's mean and squared deviations, these weighted and added up.
void SeedSpread::add(const FloatImage& image) {
    if (image.width != reference_.width || image.height != reference_.height)
        throw Error(ErrorCode::invalidArgument, "a picture and its reference differ in size");
    ++pictures_;
    double squares = 0;
    for (size_t c = 0; c < kChannels.size(); ++c) {
        const auto &values = image.plane(kChannels[c]), &wanted = reference_.plane(kChannels[c]);
        for (size_t i = 0; i < values.size(); ++i) {
            const double weight = weightOf(wanted[i]), step = double{values[i]} - wanted[i];
            squares += weight * step * step;
            const double before = values[i] - means_[c][i];
            means_[c][i] += before / static_cast<double>(pictures_);
            spread_ += weight * before * (values[i] - means_[c][i]);
        }
    }
    squares_ += squares / static_cast<double>(kChannels.size() * reference_.pixelCount());
}

double SeedSpread::meanSquare() const {
    return pictures_ == 0 ? 0 : squares_ / static_cast<double>(pictures_) - referenceVariance_;
}

double SeedSpread::variance() const {
    if (pictures_ < 2) return 0;
    return spread_ / static_cast<double>((pictures_ - 1) * kChannels.size() * reference_.pixelCount());
}

std::vector<bool> paretoFront(std::span<const CostPoint> points) {
    std::vector<bool> front(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
        const CostPoint& own = points[i];
        front[i] = std::none_of(points.begin(), points.end(), [&](const CostPoint& other) {
            return other.seconds <= own.seconds && other.error <= own.error &&
                   (other.seconds < own.seconds || other.error < own.error);
        });
    }
    return front;
}

}  // namespace tilefarm
