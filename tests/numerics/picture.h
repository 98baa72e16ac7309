#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "tests/numerics/statistics.h"
#include "tests/support/test_scenes.h"
#include "worker/render/renderer.h"

/// Whole frames through the real renderer and the pass schedule, and what the cases measure on them.
namespace tilefarm {

struct Picture {
    std::vector<FilmPixel> pixels;  // rows from the top
    RenderStats stats;
    uint32_t width = 0;
};

struct Shot {
    uint32_t size = 16;  // pixels, square
    uint32_t samples = 16;
    uint32_t maxBounces = 4;
    uint32_t rouletteStart = 4;
    uint32_t seed = 1;
    uint64_t forcedFeatures = 0;
    DirectLight directLight = DirectLight::mis;
    LightSelection lightSelection = LightSelection::power;
    double clampDirect = 0, clampIndirect = 0, regularisation = 0;  // off, as a job has them
};

ImageSpec imageOf(const Shot& shot);
RenderSettings settingsOf(const Shot& shot);
Picture render(const gpu::Device& device, const Scene& scene, const Camera& camera, const Shot& shot);

bool hit(const FilmPixel& pixel);
bool anyPixel(const FilmPixel&);
/// Mean of a channel over the pixels that `choose` takes.
Mean meanOf(const Picture& picture, int channel = 0, bool (*choose)(const FilmPixel&) = anyPixel);
/// Σ (a − b)² / Σ (b² + 1e-4) over pixels and channels: relMSE of a against b.
double relMse(const Picture& a, const Picture& b);
size_t blackPixels(const Picture& picture, bool (*choose)(const FilmPixel&) = anyPixel);
bool allFinite(const Picture& picture);
double furthestPixel(const Picture& a, const Picture& b);
bool sameBits(const Picture& a, const Picture& b);

/// Irradiance of a polygon of unit radiance: Lambert's formula, ½ Σ angle of an edge times the cosine of its
/// plane. The whole polygon lies above the surface.
double polygonIrradiance(const std::vector<glm::dvec3>& corners, const glm::dvec3& point,
                         const glm::dvec3& normal);

}  // namespace tilefarm
