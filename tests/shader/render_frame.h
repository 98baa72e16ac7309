#pragma once

#include <cmath>
#include <vector>

#include "shared/film/film.h"
#include "worker/render/renderer.h"
#include "worker/vk/device.h"

/// Frames through the real renderer, and their means with what is needed to judge them.
namespace tilefarm {

ImageSpec square(uint32_t size, uint32_t tile = 128);
/// Without culling: scenes of tests are made of faces that are looked at from both sides.
RenderSettings bounces(uint32_t count, uint32_t seed = 1);
std::vector<uint32_t> allTiles(const ImageSpec& image);

/// The whole frame through the pass schedule, row by row.
std::vector<FilmPixel> renderFrame(const gpu::Device& device, const Scene& scene, const Camera& camera,
                                   const ImageSpec& image, const RenderSettings& settings, uint32_t samples);

struct Mean {
    double value = 0, sigma = 0;
};

/// Mean of a channel over pixels of a region, with the standard deviation of that mean.
template <typename Choose>
Mean meanOf(const std::vector<FilmPixel>& frame, int channel, Choose choose) {
    double sum = 0, variance = 0;
    int n = 0;
    for (const FilmPixel& pixel : frame) {
        if (!choose(pixel)) continue;
        sum += pixel.mean[static_cast<size_t>(channel)];
        variance += pixel.varianceOfMean(channel);
        ++n;
    }
    return {sum / n, std::sqrt(variance) / n};
}

Mean meanOf(const std::vector<FilmPixel>& frame, int channel = 0);
bool hit(const FilmPixel& pixel);

/// z-test against a known value: 4σ, plus `slack` for what fp32 and closed form differ by.
void expectMean(const Mean& mean, double expected, double slack = 1e-5);
/// z-test of two estimates of the same value: 4σ of their difference.
void expectSame(const Mean& a, const Mean& b, double slack = 1e-6);

}  // namespace tilefarm
