#include "shared/image/png.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include "shared/error/error.h"
#include "shared/file/durable_file.h"

namespace tilefarm {

RgbImage toneMapped(const FloatImage& image, const ToneMapping& mapping) {
    const std::vector<float>&r = image.plane("R"), &g = image.plane("G"), &b = image.plane("B");
    RgbImage out{image.width, image.height, std::vector<unsigned char>(3 * image.pixelCount())};
    for (size_t i = 0; i < image.pixelCount(); ++i) {
        const auto display = toDisplay({r[i], g[i], b[i]}, mapping);
        std::copy(display.begin(), display.end(), out.pixels.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
    return out;
}

std::vector<std::byte> encodePng(const RgbImage& image) {
    if (image.width == 0 || image.height == 0 ||
        image.pixels.size() != size_t{3} * image.width * image.height)
        throw Error(ErrorCode::invalidArgument, "a PNG needs pixels, three bytes for each");
    std::vector<std::byte> png;
    const auto append = [](void* context, void* data, int size) {
        const auto* bytes = static_cast<const std::byte*>(data);
        static_cast<std::vector<std::byte>*>(context)->insert(
            static_cast<std::vector<std::byte>*>(context)->end(), bytes, bytes + size);
    };
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    if (!stbi_write_png_to_func(append, &png, width, height, 3, image.pixels.data(), 3 * width))
        throw Error(ErrorCode::internal, "encoding a PNG failed for want of memory");
    return png;
}

void writePng(const std::filesystem::path& path, const RgbImage& image) {
    writeDurably(path, encodePng(image));
}

}  // namespace tilefarm
