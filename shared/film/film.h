#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/film/layout.h"
#include "shared/job/pass_schedule.h"

namespace tilefarm {

/// One pixel of one pass as the kernel leaves it (64 bytes, four RGBA32F texels; gpu_types.h has the
/// same layout). Radiance in linear Rec.709. `count` is the number of finite samples: the pass's
/// sample count less those dropped as NaN or infinite.
struct PassPixel {
    std::array<float, 3> mean{};  // radiance
    float count = 0;
    std::array<float, 3> m2{};      // sum of squared deviations from the mean, per channel
    float m2Luminance = 0;          // the same of Rec.709 luminance
    std::array<float, 3> albedo{};  // means of the auxiliary channels over the same samples
    float depth = 0;                // scene units along the ray; 0 where nothing was hit
    std::array<float, 3> normal{};  // world space shading normal; 0 where nothing was hit
    float alpha = 0;                // share of camera rays that hit a surface
};
static_assert(sizeof(PassPixel) == 64, "must match shaders/gpu_types.h");

/// A sample that was NaN or infinite; with scene, settings and frame it can be rendered again alone.
struct DroppedSample {
    uint32_t x = 0, y = 0;  // pixel of the image
    uint32_t sample = 0;
    friend bool operator==(const DroppedSample&, const DroppedSample&) = default;
};

/// What went wrong, or was left out, while samples were taken. The number of dropped samples stands in the
/// pixels' counts.
struct PassFaults {
    uint64_t rejectedPaths = 0;          // ended on a direction without probability or in too many solids
    uint64_t truncatedPaths = 0;         // still carried light where the bounce limit ended them
    double truncatedThroughput = 0;      // largest channel of what they carried, summed up
    uint64_t clampedSamples = 0;         // that settings.clampDirect or clampIndirect bounded
    double clampedLuminance = 0;         // that it took away, summed up, W/(sr m²)
    uint64_t lightsBehindGlass = 0;      // samples of lights without extent that ended at smooth solid glass
    std::vector<DroppedSample> dropped;  // the first few
    /// Keeps at most `kMostDropped` samples.
    void add(const PassFaults& other);
    friend bool operator==(const PassFaults&, const PassFaults&) = default;
};
inline constexpr size_t kMostDropped = 16;

/// Film of one pass of one tile.
struct PassFilm {
    uint32_t tile = 0;
    Rect rect;
    SampleRange samples;
    std::vector<PassPixel> pixels{};  // rect.width * rect.height, rows from the top
    PassFaults faults{};
    FilmLayout layout{};
    std::vector<float> extra{};  // layout.floats() for each pixel

    std::span<const float> extraOf(size_t pixel) const {
        return std::span(extra).subspan(pixel * layout.floats(), layout.floats());
    }
};

/// Throws Error(unprocessable) that names tile and pixel where a film is not what a kernel can leave:
/// the wrong number of pixels, a NaN or infinite mean, a count beyond that of the pass, ids that stand
/// twice. What a server asks of an upload before it keeps it.
void requireUsable(const PassFilm& pass);

/// One pixel of a frame: everything in double, since it takes thousands of merges.
struct FilmPixel {
    std::array<double, 3> mean{};
    std::array<double, 3> m2{};
    double m2Luminance = 0;
    std::array<double, 3> albedo{};
    std::array<double, 3> normal{};
    double depth = 0;
    double alpha = 0;
    double count = 0;    // finite samples merged
    double dropped = 0;  // NaN or infinite samples

    /// Adds a pass that rendered `samples` samples of this pixel (Chan, Golub, LeVeque 1983: pairwise
    /// update of mean and M2). Rounding depends on the order of calls: merge in sample order.
    void merge(const PassPixel& pass, uint32_t samples);
    /// Variance of the mean of channel c: M2 / (n (n − 1)); 0 while n < 2.
    double varianceOfMean(int channel) const;
    double luminance() const;
    double varianceOfMeanLuminance() const;
};

/// A rectangle of a frame with all passes merged so far.
struct FilmTile {
    Rect rect;
    uint32_t mergedSamples = 0;  // passes covering [0, mergedSamples) are in
    std::vector<FilmPixel> pixels;
    FilmLayout layout;
    std::vector<double> extra;  // as PassFilm::extra

    explicit FilmTile(Rect r = {}, const FilmLayout& l = {})
        : rect(r), pixels(r.area()), layout(l), extra(r.area() * l.floats()) {}
    /// Throws Error(conflict) unless pass.samples.first == mergedSamples, Error(unprocessable) if
    /// rectangles or layouts differ or requireUsable refuses it; the tile is then as before.
    /// Of the ids that a pixel's samples meet the first kMatteRanks are kept, in the order of samples, so
    /// that no cut into tiles or leases shows; samples of further ones are counted nowhere. (A pass keeps the
    /// first that it meets itself: where there are more, some samples of the kept ones are missing too.)
    void merge(const PassFilm& pass);

    std::span<double> extraOf(size_t pixel) {
        return std::span(extra).subspan(pixel * layout.floats(), layout.floats());
    }
};

}  // namespace tilefarm
