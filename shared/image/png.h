#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "shared/image/float_image.h"
#include "shared/image/tone.h"

namespace tilefarm {

/// 8-bit RGB, rows from the top.
struct RgbImage {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<unsigned char> pixels;  // 3 * width * height
};

/// Takes the channels R, G and B. Throws Error(invalidArgument) if one is missing.
RgbImage toneMapped(const FloatImage& image, const ToneMapping& mapping);
std::vector<std::byte> encodePng(const RgbImage& image);
/// Written beside `path` and renamed. Throws Error(internal | outOfSpace) that names the file.
void writePng(const std::filesystem::path& path, const RgbImage& image);

}  // namespace tilefarm
