// By libjpeg-turbo, as hostile files call for a decoder that is kept in repair: stb_image 2.27, which Debian
// 12 has, writes past its Huffman tables (found by image_fuzzer; also CVE-2022-28041, -28042 and -28048).
#include <fmt/format.h>

#include <csetjmp>
#include <cstdio>  // jpeglib.h wants FILE

#include <jerror.h>
#include <jpeglib.h>

#include "shared/error/error.h"
#include "worker/scene/image_decoders.h"

namespace tilefarm {
namespace {

// A block of 8 x 8 takes a bit at least, in its first scan.
constexpr uint64_t kJpegTexelsPerByte = 512;
// A progressive file has about ten; each costs a pass over the image.
constexpr int kMostScans = 100;

// libjpeg leaves by longjmp, so that nothing with a destructor may live in a function that calls it.
struct Decoder {
    jpeg_decompress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg_progress_mgr progress{};
    std::jmp_buf leave{};
    char fault[JMSG_LENGTH_MAX]{};
};

Decoder& decoderOf(j_common_ptr jpeg) {
    return *static_cast<Decoder*>(jpeg->client_data);
}

[[noreturn]] void onError(j_common_ptr jpeg) {
    Decoder& decoder = decoderOf(jpeg);
    jpeg->err->format_message(jpeg, decoder.fault);
    std::longjmp(decoder.leave, 1);
}

// Data that is cut short or damaged would be filled up with grey.
void onMessage(j_common_ptr jpeg, int level) {
    const int code = jpeg->err->msg_code;
    if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE))
        onError(jpeg);
}

void onProgress(j_common_ptr jpeg) {
    if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMostScans) return;
    std::snprintf(decoderOf(jpeg).fault, JMSG_LENGTH_MAX, "it has more than %d scans", kMostScans);
    std::longjmp(decoderOf(jpeg).leave, 1);
}

bool open(Decoder& decoder, std::span<const std::byte> bytes) {
    jpeg_decompress_struct& jpeg = decoder.jpeg;
    jpeg.err = jpeg_std_error(&decoder.errors);
    decoder.errors.error_exit = onError;
    decoder.errors.emit_message = onMessage;
    jpeg.client_data = &decoder;
    if (setjmp(decoder.leave)) return false;
    jpeg_create_decompress(&jpeg);
    decoder.progress.progress_monitor = onProgress;
    jpeg.progress = &decoder.progress;
    jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&jpeg, TRUE);
    const bool inks = jpeg.jpeg_color_space == JCS_CMYK || jpeg.jpeg_color_space == JCS_YCCK;
    jpeg.out_color_space = inks ? JCS_CMYK : JCS_EXT_RGBA;
    return true;
}

bool read(Decoder& decoder, uint8_t* out) {
    jpeg_decompress_struct& jpeg = decoder.jpeg;
    if (setjmp(decoder.leave)) return false;
    jpeg_start_decompress(&jpeg);
    while (jpeg.output_scanline < jpeg.output_height) {
        JSAMPROW row = out + size_t{jpeg.output_scanline} * jpeg.output_width * 4;
        jpeg_read_scanlines(&jpeg, &row, 1);
    }
    return true;
}

// Adobe, whose files these are, stores what ink leaves of the light.
void makeRgb(std::vector<uint8_t>& texels) {
    for (size_t i = 0; i < texels.size(); i += 4) {
        const unsigned black = texels[i + 3];
        for (size_t c = 0; c < 3; ++c)
            texels[i + c] = static_cast<uint8_t>((texels[i + c] * black + 127) / 255);
        texels[i + 3] = 255;
    }
}

}  // namespace

Image decodeJpeg(std::span<const std::byte> bytes) {
    Decoder decoder;
    const struct Closer {
        Decoder& decoder;
        ~Closer() { jpeg_destroy_decompress(&decoder.jpeg); }
    } closer{decoder};
    const auto require = [&](bool well) {
        if (!well)
            throw Error(ErrorCode::invalidArgument,
                        fmt::format("the JPEG cannot be decoded: {}", decoder.fault));
    };
    require(open(decoder, bytes));
    Image image;
    image.width = decoder.jpeg.image_width;
    image.height = decoder.jpeg.image_height;
    requireModestImage(image.width, image.height, bytes.size(), kJpegTexelsPerByte);
    image.rgba8.resize(size_t{image.width} * image.height * 4);
    require(read(decoder, image.rgba8.data()));
    if (decoder.jpeg.out_color_space == JCS_CMYK) makeRgb(image.rgba8);
    return image;
}

}  // namespace tilefarm
