#include "tests/numerics/picture.h"

#include <cmath>
#include <cstring>
#include <numeric>

namespace tilefarm {

ImageSpec imageOf(const Shot& shot) {
    ImageSpec image;
    image.width = image.height = shot.size;
    return image;
}

RenderSettings settingsOf(const Shot& shot) {
    RenderSettings settings;
    settings.maxBounces = shot.maxBounces;
    settings.rouletteStart = shot.rouletteStart;
    settings.seed = shot.seed;
    settings.directLight = shot.directLight;
    settings.lightSelection = shot.lightSelection;
    settings.clampDirect = shot.clampDirect;
    settings.clampIndirect = shot.clampIndirect;
    settings.regularisation = shot.regularisation;
    settings.culling = Culling::none;  // scenes are of faces that are looked at from both sides
    return settings;
}

Picture render(const gpu::Device& device, const Scene& scene, const Camera& camera, const Shot& shot) {
    const ImageSpec image = imageOf(shot);
    Renderer renderer(device, scene, camera, image, settingsOf(shot), {}, shot.forcedFeatures);
    const TileGrid grid(image);
    std::vector<uint32_t> indices(grid.count());
    std::iota(indices.begin(), indices.end(), 0u);
    std::vector<FilmTile> tiles;
    for (const uint32_t i : indices) tiles.emplace_back(grid.rect(i));
    for (const SampleRange& range : passSchedule(shot.samples))
        for (const PassFilm& film : renderer.render(0, indices, range)) tiles[film.tile].merge(film);
    Picture picture;
    picture.width = image.width;
    picture.stats = renderer.stats();
    picture.pixels.resize(size_t{image.width} * image.height);
    for (const FilmTile& tile : tiles)
        for (size_t i = 0; i < tile.pixels.size(); ++i)
            picture.pixels[(tile.rect.y + i / tile.rect.width) * image.width + tile.rect.x +
                           i % tile.rect.width] = tile.pixels[i];
    return picture;
}

bool hit(const FilmPixel& pixel) {
    return pixel.alpha == 1;
}
bool anyPixel(const FilmPixel&) {
    return true;
}

Mean meanOf(const Picture& picture, int channel, bool (*choose)(const FilmPixel&)) {
    double sum = 0, variance = 0;
    int n = 0;
    for (const FilmPixel& pixel : picture.pixels) {
        if (!choose(pixel)) continue;
        sum += pixel.mean[static_cast<size_t>(channel)];
        variance += pixel.varianceOfMean(channel);
        ++n;
    }
    EXPECT_GT(n, 0) << "no pixel to look at";
    return {sum / n, std::sqrt(variance) / n};
}

double relMse(const Picture& a, const Picture& b) {
    double difference = 0, square = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i)
        for (size_t c = 0; c < 3; ++c) {
            difference += std::pow(a.pixels[i].mean[c] - b.pixels[i].mean[c], 2);
            square += std::pow(b.pixels[i].mean[c], 2) + 1e-4;
        }
    recordWorst("relmse", difference / square);
    return difference / square;
}

size_t blackPixels(const Picture& picture, bool (*choose)(const FilmPixel&)) {
    size_t black = 0;
    for (const FilmPixel& pixel : picture.pixels) black += choose(pixel) && !(pixel.luminance() > 0);
    return black;
}

bool allFinite(const Picture& picture) {
    for (const FilmPixel& pixel : picture.pixels)
        for (size_t c = 0; c < 3; ++c)
            if (!std::isfinite(pixel.mean[c]) || !std::isfinite(pixel.m2[c])) return false;
    return true;
}

double furthestPixel(const Picture& a, const Picture& b) {
    double furthest = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i)
        for (size_t c = 0; c < 3; ++c)
            furthest = std::max(furthest, std::abs(a.pixels[i].mean[c] - b.pixels[i].mean[c]));
    recordWorst("pixel", furthest);
    return furthest;
}

bool sameBits(const Picture& a, const Picture& b) {
    return a.pixels.size() == b.pixels.size() &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(FilmPixel)) == 0;
}

double polygonIrradiance(const std::vector<glm::dvec3>& corners, const glm::dvec3& point,
                         const glm::dvec3& normal) {
    double sum = 0;
    for (size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = corners[i] - point, b = corners[(i + 1) % corners.size()] - point;
        const glm::dvec3 across = glm::cross(a, b);
        const double length = glm::length(across);
        // An edge in line with the point spans no angle. (atan2: acos of a dot product near 1 has half the
        // digits.)
        if (length > 0) sum += std::atan2(length, glm::dot(a, b)) * glm::dot(across, normal) / length;
    }
    return std::abs(sum) / 2;
}

}  // namespace tilefarm
