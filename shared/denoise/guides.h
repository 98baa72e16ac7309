#pragma once

// What the denoiser's passes go by: a band of the frame with margins, and what was measured of it.

#include <array>
#include <cstddef>
#include <vector>

#include "shared/denoise/denoise.h"
#include "shared/denoise/parallel.h"

namespace tilefarm {

using Plane = std::vector<float>;
using Colour = std::array<Plane, 3>;

inline float square(float x) {
    return x * x;
}

/// exp(-x) for x ≥ 0, nearly, but exactly 0 from 4 on; 1 for x < 0.
inline float kernelOf(float x) {
    const float t = 1.f - 0.25f * (x > 0.f ? x : 0.f);
    const float most = t > 0.f ? t : 0.f;
    return (most * most) * (most * most);
}

inline constexpr float kLeastNoise = 1e-37f;  // divides where there is none

/// Geometry of a band: pixels (0, 0) … (width - 1, rows - 1), and `margin` more on all sides.
struct BandShape {
    int width = 0, rows = 0, margin = 0;
    int stride() const { return width + 2 * margin; }
    size_t pixels() const { return static_cast<size_t>(stride()) * static_cast<size_t>(rows + 2 * margin); }
    size_t at(int x, int y) const {
        return static_cast<size_t>(y + margin) * static_cast<size_t>(stride()) +
               static_cast<size_t>(x + margin);
    }
};

/// Planes of a band with its margins. Beyond the frame its border is repeated, with share 0, or wraps around.
struct Guides {
    BandShape shape;
    Colour radiance;     // over reflectance
    Colour reflectance;  // what it was divided by
    Colour albedo, normal;
    Plane depth, alpha;
    Plane share;     // 1; 0 where a pixel must not be averaged into others
    Plane measured;  // variance of the mean of `radiance`, summed over channels
    Plane noise;     // the same, smoothed
    // Squared lengths of gradients.
    Plane normalGradient, albedoGradient, alphaGradient, depthGradient;

    /// Reads rows [first, first + rows) of a frame of width x height pixels, with `margin` more.
    void read(int first, const BandShape& band, int height, bool wrap, uint32_t threads,
              const RowSource& source);
    /// The frame's own values as they were read: those of the band's pixel (x, y).
    float raw(size_t channel, int x, int y) const {
        return rows_.radiance[channel][static_cast<size_t>(y + above_) * static_cast<size_t>(shape.width) +
                                       static_cast<size_t>(x)];
    }
    /// 1 where two pixels are much alike in what they show, 0 where not at all.
    float sameSurface(size_t p, size_t q) const;

    /// Calls work(x, y) for all pixels of the band and `reach` more on all sides.
    template <typename Work>
    void forAll(int reach, uint32_t threads, const Work& work) const {
        inParallel(threads, shape.rows + 2 * reach, [&](int row) {
            for (int x = -reach; x < shape.width + reach; ++x) work(x, row - reach);
        });
    }

    /// How far beyond a pixel its noise and gradients look.
    static int reach();

private:
    void resize();
    void take(size_t to, size_t from, bool inside);
    void measureNoise(uint32_t threads);
    void measureGradients(uint32_t threads);
    float spreadAround(int x, int y) const;
    float gradient(const Plane& plane, size_t p) const;
    float slope(const Plane& plane, size_t p) const;

    GuidedRows rows_;
    int above_ = 0;  // rows of `rows_` above the band
    Plane counts_;
};

}  // namespace tilefarm
