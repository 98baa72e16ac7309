#include "worker/scene/decode_image.h"

#include <fmt/format.h>

#include <string_view>

#include "shared/error/error.h"
#include "worker/scene/image_decoders.h"
#include "worker/scene/limits.h"

namespace tilefarm {

void requireModestImage(uint64_t width, uint64_t height, size_t bytes, uint64_t texelsPerByte) {
    if (width == 0 || height == 0 || width * height > kMaxImageTexels) {
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("the image has {} x {} texels, at most {} are allowed", width, height,
                                kMaxImageTexels));
    }
    if (width * height / texelsPerByte > bytes) {
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("the image's {} bytes cannot hold its {} x {} texels", bytes, width, height));
    }
}

Image decodeImage(std::span<const std::byte> bytes, bool srgb) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\x89PNG")) return decodePng(bytes, srgb);
    if (text.starts_with("\xff\xd8")) return decodeJpeg(bytes);
    throw Error(
        ErrorCode::invalidArgument,
        fmt::format("the image cannot be decoded: its {} bytes are neither PNG nor JPEG", bytes.size()));
}

}  // namespace tilefarm
