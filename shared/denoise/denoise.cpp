#include "shared/denoise/denoise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "shared/denoise/guides.h"
#include "shared/error/error.h"

namespace tilefarm {

namespace {

constexpr int kPatch = 2;        // radius of the patches that the first pass compares
constexpr int kGuidePatch = 1;   // of those of the second pass, whose noise is small and correlated
constexpr int kTrustRadius = 2;  // over which the second pass is held against what was measured
constexpr int kBlockWidth = 64, kBlockHeight = 16;  // of pixels worked on at a time: what a cache holds

constexpr float kFarApart = 1e4f;     // any distance this large is as good as infinite
constexpr float kLeastDepth = 1e-4f;  // squared relative difference of depths that is no edge
// A neighbour's variance excuses a difference up to so many times the pixel's own. Without a bound, clean
// pixels take in the noise of bright ones beside them; at 1 a rare bright sample is taken out of its own
// pixel and given to no other, which costs up to 2 % of a picture's light (here 0.7 %; measured on the demo
// scene).
constexpr float kMostBorrowed = 40;
// In the second pass two pixels that are so many times nearer than their patches are taken to be alike:
// patches across an edge match along the edge alone, and would leave its noise.
constexpr float kAlone = 4;
// What the change of a window by the second pass may be above the noise that it should have removed.
constexpr float kLeeway = 2;

// The passes over one band. What a pixel becomes depends on the frame's pixels within the margin and on
// nothing else, so bands and threads decide no bit.
class BandFilter {
public:
    BandFilter(const DenoiseSettings& settings, uint32_t threads, const Guides& guides)
        : settings_(settings), threads_(threads), guides_(guides), shape_(guides.shape) {
        for (Colour* colour : {&guide_, &result_})
            for (Plane& plane : *colour) plane.resize(shape_.pixels());
        for (Plane* plane : {&guideNoise_, &ownShare_}) plane->resize(shape_.pixels());
    }

    Colour run() {
        const int radius = static_cast<int>(settings_.radius);
        average<kPatch>(guides_.radiance, guides_.noise, settings_.noiseTolerance,
                        radius + kGuidePatch + kTrustRadius, guide_, [&](size_t p, const Sums& s, size_t i) {
                            guideNoise_[p] =
                                s.weight[i] > 0 ? s.variance[i] / square(s.weight[i]) : guides_.noise[p];
                        });
        average<kGuidePatch>(guide_, guideNoise_, settings_.guideTolerance, kTrustRadius, result_,
                             [&](size_t p, const Sums& s, size_t i) {
                                 ownShare_[p] = s.weight[i] > 0 ? guides_.share[p] / s.weight[i] : 1.f;
                             });
        return picture();
    }

private:
    using Block = std::array<float, kBlockWidth * kBlockHeight>;
    struct Corner {
        int x, y, width, height;
    };
    struct Sums {  // over the window of each pixel of a block
        Block weight{}, red{}, green{}, blue{}, variance{};
    };

    // Mean over patches of how much further apart two pixels are than their noise explains, in units of the
    // tolerance: 0 on average for pixels that differ by noise alone.
    template <int Patch>
    void compare(const Colour& values, const Plane& noise, float tolerance, const Corner& b,
                 std::ptrdiff_t offset, Block& distance) const {
        float terms[kBlockWidth + 2 * Patch], sums[kBlockHeight + 2 * Patch][kBlockWidth];
        const float tolerated = square(tolerance);
        for (int y = 0; y < b.height + 2 * Patch; ++y) {
            const size_t p = shape_.at(b.x - Patch, b.y - Patch + y);
            const float *red = &values[0][p], *green = &values[1][p], *blue = &values[2][p], *n = &noise[p];
            for (int x = 0; x < b.width + 2 * Patch; ++x) {
                const float both = n[x] + std::min(n[x + offset], kMostBorrowed * n[x]);
                const float apart = square(red[x] - red[x + offset]) + square(green[x] - green[x + offset]) +
                                    square(blue[x] - blue[x + offset]);
                terms[x] = std::min((apart - both) / (tolerated * both + kLeastNoise), kFarApart);
            }
            if (Patch == kGuidePatch && y >= Patch && y < b.height + Patch)
                std::copy_n(terms + Patch, b.width,
                            &distance[static_cast<size_t>((y - Patch) * kBlockWidth)]);
            for (int x = 0; x < b.width; ++x) {
                float sum = terms[x];
                for (int i = 1; i <= 2 * Patch; ++i) sum += terms[x + i];
                sums[y][x] = sum;
            }
        }
        constexpr float share = 1.f / ((2 * Patch + 1) * (2 * Patch + 1));
        for (int y = 0; y < b.height; ++y)
            for (int x = 0; x < b.width; ++x) {
                float sum = sums[y][x];
                for (int i = 1; i <= 2 * Patch; ++i) sum += sums[y + i][x];
                float& d = distance[static_cast<size_t>(y * kBlockWidth + x)];
                d = Patch == kGuidePatch ? std::min(sum * share, kAlone * d) : sum * share;
            }
    }

    // Makes distances weights, after raising them to that of the feature that differs most.
    void weigh(const Corner& b, int dx, int dy, Block& distance) const {
        const std::ptrdiff_t offset = offsetOf(dx, dy);
        const float half = 0.5f * square(settings_.featureTolerance);
        const auto steps = static_cast<float>(dx * dx + dy * dy);
        const Guides& g = guides_;
        for (int y = 0; y < b.height; ++y) {
            const size_t p = shape_.at(b.x, b.y + y);
            const float *nx = &g.normal[0][p], *ny = &g.normal[1][p], *nz = &g.normal[2][p];
            const float *ar = &g.albedo[0][p], *ag = &g.albedo[1][p], *ab = &g.albedo[2][p];
            const float *z = &g.depth[p], *alpha = &g.alpha[p], *share = &g.share[p];
            const float *slopeN = &g.normalGradient[p], *slopeA = &g.albedoGradient[p],
                        *slopeZ = &g.depthGradient[p], *slopeAlpha = &g.alphaGradient[p];
            float* __restrict d = &distance[static_cast<size_t>(y * kBlockWidth)];
            for (int x = 0; x < b.width; ++x) {
                const std::ptrdiff_t q = x + offset;
                const float normals =
                    (square(nx[x] - nx[q]) + square(ny[x] - ny[q]) + square(nz[x] - nz[q])) /
                    (half * (slopeN[x] + slopeN[q]));
                const float albedos =
                    (square(ar[x] - ar[q]) + square(ag[x] - ag[q]) + square(ab[x] - ab[q])) /
                    (half * (slopeA[x] + slopeA[q]));
                const float alphas = square(alpha[x] - alpha[q]) / (half * (slopeAlpha[x] + slopeAlpha[q]));
                const float depths =
                    square(z[x] - z[q]) /
                    (half * ((slopeZ[x] + slopeZ[q]) * steps + kLeastDepth * (square(z[x]) + square(z[q]))) +
                     kLeastNoise);
                d[x] = std::max(std::max(std::max(d[x], normals), std::max(albedos, alphas)), depths);
            }
            for (int x = 0; x < b.width; ++x) d[x] = kernelOf(d[x]) * share[x + offset];
        }
    }

    void accumulate(const Corner& b, std::ptrdiff_t offset, const Block& weight, Sums& sums) const {
        for (int y = 0; y < b.height; ++y) {
            const size_t p = shape_.at(b.x, b.y + y);
            const auto row = static_cast<size_t>(y * kBlockWidth);
            const float *red = &guides_.radiance[0][p], *green = &guides_.radiance[1][p],
                        *blue = &guides_.radiance[2][p], *noise = &guides_.noise[p], *w = &weight[row];
            for (int x = 0; x < b.width; ++x) {
                const size_t i = row + static_cast<size_t>(x);
                sums.weight[i] += w[x];
                sums.red[i] += w[x] * (red[x + offset] - red[x]);
                sums.green[i] += w[x] * (green[x + offset] - green[x]);
                sums.blue[i] += w[x] * (blue[x + offset] - blue[x]);
                sums.variance[i] += square(w[x]) * noise[x + offset];
            }
        }
    }

    // Averages the radiance of the band and `reach` more on all sides by weights from patches of `values`, as
    // steps from each pixel's own value, so that equal ones leave it exactly as it is. Then calls
    // also(p, sums, i) for each pixel.
    template <int Patch, typename Also>
    void average(const Colour& values, const Plane& noise, float tolerance, int reach, Colour& averages,
                 const Also& also) {
        const int width = shape_.width + 2 * reach, height = shape_.rows + 2 * reach;
        const int across = (width + kBlockWidth - 1) / kBlockWidth;
        const int down = (height + kBlockHeight - 1) / kBlockHeight;
        inParallel(threads_, across * down, [&](int block) {
            const int x = block % across * kBlockWidth, y = block / across * kBlockHeight;
            const Corner b{x - reach, y - reach, std::min(kBlockWidth, width - x),
                           std::min(kBlockHeight, height - y)};
            const Sums sums = sumsOf<Patch>(values, noise, tolerance, b);
            for (int row = 0; row < b.height; ++row)
                for (int column = 0; column < b.width; ++column) {
                    const size_t p = shape_.at(b.x + column, b.y + row);
                    const auto i = static_cast<size_t>(row * kBlockWidth + column);
                    const float weight = sums.weight[i];
                    averages[0][p] = guides_.radiance[0][p] + (weight > 0 ? sums.red[i] / weight : 0.f);
                    averages[1][p] = guides_.radiance[1][p] + (weight > 0 ? sums.green[i] / weight : 0.f);
                    averages[2][p] = guides_.radiance[2][p] + (weight > 0 ? sums.blue[i] / weight : 0.f);
                    also(p, sums, i);
                }
        });
    }

    template <int Patch>
    Sums sumsOf(const Colour& values, const Plane& noise, float tolerance, const Corner& b) const {
        Sums sums;
        Block weight;
        const int radius = static_cast<int>(settings_.radius);
        for (int dy = -radius; dy <= radius; ++dy)
            for (int dx = -radius; dx <= radius; ++dx) {
                compare<Patch>(values, noise, tolerance, b, offsetOf(dx, dy), weight);
                weigh(b, dx, dy, weight);
                accumulate(b, offsetOf(dx, dy), weight, sums);
            }
        return sums;
    }

    // How much of the change to take, 0 … 1. Stein's estimate of the error of raw + t (averaged - raw) is
    // least at t = Σ variance (1 - own share) / Σ change², here over a small window and relative to the
    // radiance (without the weights' own dependence on the noise, for which there is the leeway). Where the
    // change is larger than the noise that was measured, the average has lost detail.
    float trust(int x, int y) const {
        const size_t p = shape_.at(x, y);
        float changed = 0, explained = 0;
        for (int dy = -kTrustRadius; dy <= kTrustRadius; ++dy)
            for (int dx = -kTrustRadius; dx <= kTrustRadius; ++dx) {
                const size_t q = shape_.at(x + dx, y + dy);
                float scale = kLeastNoise, change = 0;
                for (size_t c = 0; c < 3; ++c) {
                    scale += square(result_[c][q]);
                    change += square(result_[c][q] - guides_.radiance[c][q]);
                }
                const float w = guides_.share[q] * guides_.sameSurface(p, q) /
                                (1 + 0.3f * static_cast<float>(dx * dx + dy * dy));
                changed += w * (change / scale);
                explained += w * (guides_.measured[q] * (1 - ownShare_[q]) / scale);
            }
        return explained * kLeeway < changed ? explained * kLeeway / changed : 1.f;
    }

    Colour picture() const {
        Colour out;
        for (Plane& plane : out)
            plane.resize(static_cast<size_t>(shape_.rows) * static_cast<size_t>(shape_.width));
        guides_.forAll(0, threads_, [&](int x, int y) {
            const size_t p = shape_.at(x, y);
            const float taken = trust(x, y);
            for (size_t c = 0; c < 3; ++c) {
                const float raw = guides_.raw(c, x, y);
                const float step =
                    taken * (result_[c][p] - guides_.radiance[c][p]) * guides_.reflectance[c][p];
                out[c][static_cast<size_t>(y) * static_cast<size_t>(shape_.width) + static_cast<size_t>(x)] =
                    step == 0 ? raw : std::max(0.f, raw + step);
            }
        });
        return out;
    }

    std::ptrdiff_t offsetOf(int dx, int dy) const { return std::ptrdiff_t{dy} * shape_.stride() + dx; }

    const DenoiseSettings& settings_;
    const uint32_t threads_;
    const Guides& guides_;
    const BandShape shape_;
    Colour guide_, result_;
    Plane guideNoise_, ownShare_;
};

void requireValid(const DenoiseSettings& s) {
    const auto require = [](bool good, const char* name, auto value, const char* range) {
        if (!good)
            throw Error(ErrorCode::invalidArgument,
                        fmt::format("the denoiser's {} is {}; it must be {}", name, value, range));
    };
    require(s.radius >= 1 && s.radius <= 16, "radius", s.radius, "1 … 16");
    for (const auto& [name, value] : {std::pair{"noiseTolerance", s.noiseTolerance},
                                      {"guideTolerance", s.guideTolerance},
                                      {"featureTolerance", s.featureTolerance}})
        require(value >= 0.01f && value <= 100.f, name, value, "0.01 … 100");
    require(s.bandRows >= 1 && s.bandRows <= 65536, "bandRows", s.bandRows, "1 … 65536");
}

}  // namespace

void GuidedRows::resize(size_t pixels) {
    for (auto* planes : {&radiance, &variance, &albedo, &normal})
        for (Plane& plane : *planes) plane.resize(pixels);
    for (Plane* plane : {&depth, &alpha, &samples}) plane->resize(pixels);
}

uint32_t denoiseMargin(const DenoiseSettings& settings) {
    // What is trusted by its neighbours, their windows of guides with their patches, those guides' windows
    // with theirs, and what these are made from.
    return kTrustRadius + 2 * settings.radius + kGuidePatch + kPatch + static_cast<uint32_t>(Guides::reach());
}

std::string denoiserText(const DenoiseSettings& s) {
    return fmt::format("{} {}; radius {}; noiseTolerance {}; guideTolerance {}; featureTolerance {}{}",
                       kDenoiserName, kDenoiserVersion, s.radius, s.noiseTolerance, s.guideTolerance,
                       s.featureTolerance, s.wrap ? "; wrap" : "");
}

void denoise(uint32_t width, uint32_t height, const DenoiseSettings& settings, const RowSource& source,
             const RowSink& sink) {
    requireValid(settings);
    const uint32_t threads =
        settings.threads > 0 ? settings.threads : std::max(1u, std::thread::hardware_concurrency());
    Guides guides;
    for (uint32_t first = 0; first < height; first += settings.bandRows) {
        const uint32_t rows = std::min(settings.bandRows, height - first);
        guides.read(
            static_cast<int>(first),
            {static_cast<int>(width), static_cast<int>(rows), static_cast<int>(denoiseMargin(settings))},
            static_cast<int>(height), settings.wrap, threads, source);
        sink(first, rows, BandFilter(settings, threads, guides).run());
    }
}

}  // namespace tilefarm
