#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace tilefarm {

/// Part of the "tilefarm.denoiser" attribute of images; grows whenever the result's bits may change.
inline constexpr const char* kDenoiserName = "joint-nlm";
inline constexpr int kDenoiserVersion = 1;

struct DenoiseSettings {
    uint32_t radius = 8;            // of the window that pixels are averaged over; pixels, 1 … 16
    float noiseTolerance = 0.6f;    // first pass: differences of so many standard deviations count as noise
    float guideTolerance = 1.0f;    // second pass: the same, of what noise the first pass left
    float featureTolerance = 0.8f;  // how far normals, albedo, depth and alpha may differ, in their gradients
    bool wrap = false;              // left and right edge meet, as in a panorama
    uint32_t bandRows = 64;         // held at a time; never changes a bit of the result
    uint32_t threads = 0;           // 0: one per processor; never changes a bit of the result
};

/// What the "tilefarm.denoiser" attribute says: name, version and all settings that decide the result.
std::string denoiserText(const DenoiseSettings& settings);

/// Some whole rows of a frame, planes of width * rows values: the radiance, the measured variance of its
/// mean, and the means of what the camera rays met first, as a frame's EXR holds them.
struct GuidedRows {
    std::array<std::vector<float>, 3> radiance, variance, albedo, normal;
    std::vector<float> depth, alpha, samples;
    void resize(size_t pixels);
};

/// Fills in rows [first, first + rows). Called from one thread, for bands from top to bottom; bands overlap.
using RowSource = std::function<void(uint32_t first, uint32_t rows, GuidedRows& into)>;
/// Takes rows [first, first + rows), each once, from top to bottom.
using RowSink =
    std::function<void(uint32_t first, uint32_t rows, const std::array<std::vector<float>, 3>& radiance)>;

/// Removes noise by averaging pixels that look alike, after Rousselle, Knaus, Zwicker: "Robust denoising using
/// feature and color information" (2013), with measured variances in place of a second buffer. Radiance is
/// divided by albedo first, so that textures are not smeared. A first pass compares 5x5 patches of radiance, in
/// units of their measured variance, and normals, albedo, depth and alpha in units of their gradients. A second
/// pass averages the same noisy pixels again by the first one's result. Where that changed more than the measured
/// noise explains (Stein's estimate over 5x5 pixels), the change is taken in part. A pixel hit by a rare bright
/// sample has a variance that lets it be averaged, and its neighbours take their share of it.
///
/// Biased: what differs less than the noise is averaged. Where the variance is 0 pixels keep their bits, and as
/// variances fall the windows narrow, so the result tends to the same image as the raw one. With less than
/// two samples a pixel has no variance; the spread of its 5x5 neighbours stands for it.
/// Any finite input gives a finite result; radiance above 1e15 takes no part.
/// Memory: about 200 bytes per pixel of a band and its margins (bandRows + 2 * denoiseMargin rows).
/// Throws Error(invalidArgument) for settings out of range.
void denoise(uint32_t width, uint32_t height, const DenoiseSettings& settings, const RowSource& source,
             const RowSink& sink);

/// Rows above and below that decide a pixel.
uint32_t denoiseMargin(const DenoiseSettings& settings);

}  // namespace tilefarm
