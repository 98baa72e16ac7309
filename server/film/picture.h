#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "shared/film/film.h"
#include "shared/image/png.h"

namespace tilefarm {

/// Builds an 8-bit picture of a frame from pieces in any order, scaled down by box filter to `width`
/// where that is less than the frame's. Memory is that of the picture, not of the frame.
class PictureBuilder {
public:
    PictureBuilder(uint32_t frameWidth, uint32_t frameHeight, uint32_t width, const ToneMapping& mapping);
    void add(const FilmTile& tile);
    /// Pixels of whole rows from `y` on.
    void addRows(uint32_t y, std::span<const std::array<float, 3>> pixels);
    RgbImage finish();

private:
    void add(uint32_t x, uint32_t y, const std::array<float, 3>& radiance);
    void set(size_t pixel, const std::array<float, 3>& radiance);

    struct Sum {
        std::array<float, 3> radiance{};
        float count = 0;
    };
    uint32_t frameWidth_, frameHeight_;
    ToneMapping mapping_;
    RgbImage image_;
    std::vector<Sum> sums_;  // empty at full size
};

/// Reads R, G and B of an EXR, or of one of its layers ("denoised"), some rows at a time.
void forEachRows(const std::filesystem::path& exr, const std::string& layer,
                 const std::function<void(uint32_t y, std::span<const std::array<float, 3>> pixels)>& visit);

}  // namespace tilefarm
