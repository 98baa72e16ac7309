#include "shared/film/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "shared/error/error.h"

namespace tilefarm {

namespace {

template <typename T>
double rec709Luminance(const std::array<T, 3>& rgb) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

// M2 may be infinite: a deviation of 2e19 is a finite sample whose square fp32 cannot hold.
bool isSumOfSquares(float value) {
    return value >= 0;
}

bool allFinite(const PassPixel& p) {
    const auto finite = [](float value) { return std::isfinite(value); };
    return std::all_of(p.mean.begin(), p.mean.end(), finite) &&
           std::all_of(p.albedo.begin(), p.albedo.end(), finite) &&
           std::all_of(p.normal.begin(), p.normal.end(), finite) && finite(p.depth) && finite(p.alpha);
}

const char* faultOf(const PassPixel& p, uint32_t samples) {
    if (!(p.count >= 0 && p.count <= static_cast<float>(samples)) || p.count != std::floor(p.count))
        return "its sample count is not a whole number up to that of the pass";
    if (!allFinite(p)) return "a mean is NaN or infinite";
    if (!std::all_of(p.m2.begin(), p.m2.end(), isSumOfSquares) || !isSumOfSquares(p.m2Luminance))
        return "a sum of squared deviations is negative or NaN";
    return nullptr;
}

// A pair is free or an id that a hash gives (Cryptomatte 1.2: a float that is finite and not denormal) with
// some of the pixel's samples.
const char* pairsFaultOf(std::span<const float> pairs, float samples) {
    float counted = 0;
    for (size_t i = 0; i < pairs.size(); i += 2) {
        const float id = pairs[i], count = pairs[i + 1];
        if (id == 0 && count == 0) continue;
        if (!std::isnormal(id)) return "an id is not one that a hash gives";
        if (!(count >= 1 && count <= samples) || count != std::floor(count))
            return "an id's sample count is not a whole number up to that of the pixel";
        for (size_t j = 0; j < i; j += 2)
            if (pairs[j] == id) return "an id stands twice";
        counted += count;
    }
    return counted <= samples ? nullptr : "its ids count more samples than it has";
}

const char* extraFaultOf(std::span<const float> extra, const FilmLayout& layout, float samples) {
    const auto means = extra.first(layout.means());
    if (!std::all_of(means.begin(), means.end(), [](float value) { return std::isfinite(value); }))
        return "a mean of the additional channels is NaN or infinite";
    for (size_t first = means.size(); first < extra.size(); first += 2 * kMatteRanks)
        if (const char* fault = pairsFaultOf(extra.subspan(first, 2 * kMatteRanks), samples)) return fault;
    return nullptr;
}

// Adds what a pass counted of its ids to the kept ones, where there is room.
void mergePairs(std::span<double> kept, std::span<const float> pass) {
    for (size_t p = 0; p < pass.size(); p += 2) {
        if (pass[p + 1] == 0) continue;
        size_t k = 0;
        while (k < kept.size() && kept[k] != pass[p] && kept[k + 1] != 0) k += 2;
        if (k == kept.size()) continue;
        kept[k] = pass[p];
        kept[k + 1] += pass[p + 1];
    }
}

// `share`: of the pass in the union of samples.
void mergeExtra(std::span<double> extra, std::span<const float> pass, const FilmLayout& layout,
                double share) {
    const uint32_t means = layout.means();
    for (uint32_t c = 0; c < means; ++c) extra[c] += (pass[c] - extra[c]) * share;
    for (size_t first = means; first < extra.size(); first += 2 * kMatteRanks)
        mergePairs(extra.subspan(first, 2 * kMatteRanks), pass.subspan(first, 2 * kMatteRanks));
}

// Mean of a set of n samples after one of `count` samples with mean `passMean` joins it.
template <size_t N>
void mergeMeans(std::array<double, N>& mean, const std::array<float, N>& passMean, double share) {
    for (size_t c = 0; c < N; ++c) mean[c] += (passMean[c] - mean[c]) * share;
}

double varianceOfMeanFrom(double m2, double n) {
    return n < 2 ? 0 : m2 / (n * (n - 1));
}

}  // namespace

void FilmPixel::merge(const PassPixel& pass, uint32_t samples) {
    dropped += samples - pass.count;
    if (pass.count == 0) return;

    const double total = count + pass.count;
    const double share = pass.count / total;  // of the pass in the union
    const double between = count * share;     // n_a n_b / (n_a + n_b)
    const double luminanceStep = rec709Luminance(pass.mean) - luminance();

    for (size_t c = 0; c < 3; ++c) {
        const double step = pass.mean[c] - mean[c];
        m2[c] += pass.m2[c] + step * step * between;
    }
    m2Luminance += pass.m2Luminance + luminanceStep * luminanceStep * between;
    mergeMeans(mean, pass.mean, share);
    mergeMeans(albedo, pass.albedo, share);
    mergeMeans(normal, pass.normal, share);
    depth += (pass.depth - depth) * share;
    alpha += (pass.alpha - alpha) * share;
    count = total;
}

double FilmPixel::varianceOfMean(int channel) const {
    return varianceOfMeanFrom(m2[static_cast<size_t>(channel)], count);
}
double FilmPixel::luminance() const {
    return rec709Luminance(mean);
}
double FilmPixel::varianceOfMeanLuminance() const {
    return varianceOfMeanFrom(m2Luminance, count);
}

void PassFaults::add(const PassFaults& other) {
    rejectedPaths += other.rejectedPaths;
    truncatedPaths += other.truncatedPaths;
    truncatedThroughput += other.truncatedThroughput;
    clampedSamples += other.clampedSamples;
    clampedLuminance += other.clampedLuminance;
    lightsBehindGlass += other.lightsBehindGlass;
    for (const DroppedSample& sample : other.dropped)
        if (dropped.size() < kMostDropped) dropped.push_back(sample);
}

void requireUsable(const PassFilm& pass) {
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorCode::unprocessable, fmt::format("film of tile {}, samples {}+{}: {}", pass.tile,
                                                          pass.samples.first, pass.samples.count, why));
    };
    if (pass.pixels.size() != pass.rect.area())
        refuse(fmt::format("{} pixels for a rectangle of {}", pass.pixels.size(), pass.rect.area()));
    if (pass.extra.size() != pass.pixels.size() * pass.layout.floats())
        refuse(fmt::format("{} further values for {} pixels of {}", pass.extra.size(), pass.pixels.size(),
                           pass.layout.floats()));
    for (size_t i = 0; i < pass.pixels.size(); ++i) {
        const char* fault = faultOf(pass.pixels[i], pass.samples.count);
        if (!fault) fault = extraFaultOf(pass.extraOf(i), pass.layout, pass.pixels[i].count);
        if (fault)
            refuse(fmt::format("pixel ({}, {}): {}", pass.rect.x + i % pass.rect.width,
                               pass.rect.y + i / pass.rect.width, fault));
    }
}

void FilmTile::merge(const PassFilm& pass) {
    if (pass.rect != rect)
        throw Error(
            ErrorCode::unprocessable,
            fmt::format("film of tile {} covers {}x{} pixels at ({}, {}), but the tile {}x{} at ({}, {})",
                        pass.tile, pass.rect.width, pass.rect.height, pass.rect.x, pass.rect.y, rect.width,
                        rect.height, rect.x, rect.y));
    if (pass.samples.first != mergedSamples)
        throw Error(ErrorCode::conflict,
                    fmt::format("tile {} has samples up to {} merged; a pass from {} does not follow",
                                pass.tile, mergedSamples, pass.samples.first));
    if (pass.layout != layout)
        throw Error(
            ErrorCode::unprocessable,
            fmt::format(
                "film of tile {}, samples {}+{}: its additional channels are {}, but the job's are {}",
                pass.tile, pass.samples.first, pass.samples.count, pass.layout.text(), layout.text()));
    requireUsable(pass);
    for (size_t i = 0; i < pixels.size(); ++i) {
        pixels[i].merge(pass.pixels[i], pass.samples.count);
        if (!extra.empty() && pass.pixels[i].count > 0)
            mergeExtra(extraOf(i), pass.extraOf(i), layout, pass.pixels[i].count / pixels[i].count);
    }
    mergedSamples = pass.samples.end();
}

}  // namespace tilefarm
