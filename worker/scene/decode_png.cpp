#include <fmt/format.h>
#include <png.h>

#include <array>
#include <cstring>
#include <vector>

#include "shared/error/error.h"
#include "worker/scene/image_decoders.h"
#include "worker/scene/srgb.h"

namespace tilefarm {
namespace {

// Deflate gives 1032 bytes for one at most; a byte holds eight texels of one bit.
constexpr uint64_t kPngTexelsPerByte = 1032 * 8;

// libpng leaves by longjmp, so that nothing with a destructor may live in a function that calls it.
struct Decoder {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::span<const std::byte> rest;
    std::array<char, 200> fault{};

    ~Decoder() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void onError(png_structp png, png_const_charp words) {
    auto& fault = static_cast<Decoder*>(png_get_error_ptr(png))->fault;
    std::strncpy(fault.data(), words, fault.size() - 1);
    png_longjmp(png, 1);
}

void onWarning(png_structp, png_const_charp) {}

void onRead(png_structp png, png_bytep out, size_t size) {
    auto& rest = static_cast<Decoder*>(png_get_io_ptr(png))->rest;
    if (size > rest.size()) png_error(png, "it is cut short");
    std::memcpy(out, rest.data(), size);
    rest = rest.subspan(size);
}

// Whatever is in the file comes out as four channels of 8 or 16 bits, as they are stored: gamma and profiles
// are passed over, as glTF asks.
void chooseFormat(png_structp png) {
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, 0xffff, PNG_FILLER_AFTER);
    png_set_swap(png);
    png_set_interlace_handling(png);
}

bool open(Decoder& decoder) {
    decoder.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &decoder, onError, onWarning);
    decoder.info = decoder.png ? png_create_info_struct(decoder.png) : nullptr;
    if (!decoder.info) throw std::bad_alloc();
    if (setjmp(png_jmpbuf(decoder.png))) return false;
    png_structp png = decoder.png;
    png_set_read_fn(png, &decoder, onRead);
    png_set_user_limits(png, 0x7fffffff, 0x7fffffff);  // requireModestImage bounds the product
    // Texels with a wrong check sum are still what there is.
    png_set_crc_action(png, PNG_CRC_QUIET_USE, PNG_CRC_QUIET_USE);
    png_set_benign_errors(png, 1);
    png_set_option(png, PNG_IGNORE_ADLER32, PNG_OPTION_ON);
    constexpr png_byte kOther[] =
        "iCCP\0gAMA\0cHRM\0sRGB\0tEXt\0zTXt\0iTXt\0sPLT\0hIST\0pCAL\0sCAL\0eXIf\0tIME\0bKGD";
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, kOther, sizeof kOther / 5);
    png_read_info(png, decoder.info);
    return true;
}

bool read(Decoder& decoder, uint8_t** rows) {
    if (setjmp(png_jmpbuf(decoder.png))) return false;
    chooseFormat(decoder.png);
    png_read_update_info(decoder.png, decoder.info);
    png_read_image(decoder.png, rows);
    return true;
}

std::vector<float> toFloats(const std::vector<uint8_t>& stored, bool srgb) {
    std::vector<float> floats(stored.size() / 2);
    for (size_t i = 0; i < floats.size(); ++i) {
        uint16_t value = 0;
        std::memcpy(&value, stored.data() + 2 * i, sizeof value);
        const double share = value / 65535.0;
        floats[i] = srgb && i % 4 != 3 ? static_cast<float>(srgbToLinear(share)) : static_cast<float>(share);
    }
    return floats;
}

}  // namespace

Image decodePng(std::span<const std::byte> bytes, bool srgb) {
    Decoder decoder;
    decoder.rest = bytes;
    const auto require = [&](bool well) {
        if (!well)
            throw Error(ErrorCode::invalidArgument,
                        fmt::format("the PNG cannot be decoded: {}", decoder.fault.data()));
    };
    require(open(decoder));
    Image image;
    image.width = png_get_image_width(decoder.png, decoder.info);
    image.height = png_get_image_height(decoder.png, decoder.info);
    requireModestImage(image.width, image.height, bytes.size(), kPngTexelsPerByte);
    const bool deep = png_get_bit_depth(decoder.png, decoder.info) == 16;
    const size_t rowBytes = size_t{image.width} * (deep ? 8 : 4);
    image.rgba8.resize(rowBytes * image.height);
    std::vector<uint8_t*> rows(image.height);
    for (size_t y = 0; y < rows.size(); ++y) rows[y] = image.rgba8.data() + y * rowBytes;
    require(read(decoder, rows.data()));
    if (deep) {
        image.rgbaFloat = toFloats(image.rgba8, srgb);
        image.rgba8 = {};
    }
    return image;
}

}  // namespace tilefarm
