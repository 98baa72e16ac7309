#include "tests/shader/render_frame.h"

#include <gtest/gtest.h>

#include <numeric>

namespace tilefarm {

ImageSpec square(uint32_t size, uint32_t tile) {
    ImageSpec image;
    image.width = image.height = size;
    image.tileSize = tile;
    return image;
}

RenderSettings bounces(uint32_t count, uint32_t seed) {
    RenderSettings settings;
    settings.maxBounces = count;
    settings.seed = seed;
    settings.culling = Culling::none;
    return settings;
}

std::vector<uint32_t> allTiles(const ImageSpec& image) {
    std::vector<uint32_t> tiles(TileGrid(image).count());
    std::iota(tiles.begin(), tiles.end(), 0u);
    return tiles;
}

std::vector<FilmPixel> renderFrame(const gpu::Device& device, const Scene& scene, const Camera& camera,
                                   const ImageSpec& image, const RenderSettings& settings, uint32_t samples) {
    Renderer renderer(device, scene, camera, image, settings);
    const TileGrid grid(image);
    std::vector<FilmTile> tiles;
    for (uint32_t i = 0; i < grid.count(); ++i) tiles.emplace_back(grid.rect(i));
    for (const SampleRange& range : passSchedule(samples))
        for (const PassFilm& film : renderer.render(0, allTiles(image), range)) tiles[film.tile].merge(film);
    std::vector<FilmPixel> frame(size_t{image.width} * image.height);
    for (const FilmTile& tile : tiles)
        for (uint32_t y = 0; y < tile.rect.height; ++y)
            for (uint32_t x = 0; x < tile.rect.width; ++x)
                frame[size_t{tile.rect.y + y} * image.width + tile.rect.x + x] =
                    tile.pixels[size_t{y} * tile.rect.width + x];
    return frame;
}

Mean meanOf(const std::vector<FilmPixel>& frame, int channel) {
    return meanOf(frame, channel, [](const FilmPixel&) { return true; });
}

bool hit(const FilmPixel& pixel) {
    return pixel.alpha == 1;
}

void expectMean(const Mean& mean, double expected, double slack) {
    EXPECT_NEAR(mean.value, expected, 4 * mean.sigma + slack) << "sigma " << mean.sigma;
}

void expectSame(const Mean& a, const Mean& b, double slack) {
    EXPECT_NEAR(a.value, b.value, 4 * std::hypot(a.sigma, b.sigma) + slack)
        << "sigmas " << a.sigma << ", " << b.sigma;
}

}  // namespace tilefarm
