#include "worker/scene/decode_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>

#include "shared/error/error.h"
#include "tests/support/gltf_builder.h"

namespace tilefarm {
namespace {

using Bytes = std::vector<std::byte>;

// A JPEG of one colour, of best quality.
Bytes jpeg(uint32_t width, uint32_t height, J_COLOR_SPACE space, std::vector<uint8_t> color,
           bool progressive = false) {
    jpeg_compress_struct out{};
    jpeg_error_mgr errors{};
    out.err = jpeg_std_error(&errors);
    jpeg_create_compress(&out);
    unsigned char* data = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&out, &data, &size);
    out.image_width = width;
    out.image_height = height;
    out.input_components = static_cast<int>(color.size());
    out.in_color_space = space;
    jpeg_set_defaults(&out);
    jpeg_set_quality(&out, 100, TRUE);
    if (progressive) jpeg_simple_progression(&out);
    jpeg_start_compress(&out, TRUE);
    std::vector<uint8_t> row;
    for (uint32_t x = 0; x < width; ++x) row.insert(row.end(), color.begin(), color.end());
    JSAMPROW rows = row.data();
    while (out.next_scanline < height) jpeg_write_scanlines(&out, &rows, 1);
    jpeg_finish_compress(&out);
    jpeg_destroy_compress(&out);
    const auto* first = reinterpret_cast<const std::byte*>(data);
    Bytes bytes(first, first + size);
    std::free(data);
    return bytes;
}

void expectColor(const Image& image, std::array<int, 4> color) {
    ASSERT_EQ(image.rgba8.size(), size_t{4} * image.width * image.height);
    for (size_t i = 0; i < image.rgba8.size(); ++i) ASSERT_NEAR(image.rgba8[i], color[i % 4], 2) << i;
}

void expectRefused(const Bytes& bytes, const std::string& fault) {
    try {
        decodeImage(bytes, false);
        FAIL() << "was decoded";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::invalidArgument);
        EXPECT_THAT(error.what(), testing::HasSubstr(fault));
    }
}

size_t find(const Bytes& bytes, std::initializer_list<int> what) {
    const auto same = [](std::byte a, int b) { return std::to_integer<int>(a) == b; };
    const auto at = std::search(bytes.begin(), bytes.end(), what.begin(), what.end(), same);
    EXPECT_NE(at, bytes.end());
    return static_cast<size_t>(at - bytes.begin());
}

// The size that the header of a JPEG says.
void claim(Bytes& bytes, int marker, uint32_t width, uint32_t height) {
    const size_t frame = find(bytes, {0xff, marker});
    for (const auto& [at, value] : {std::pair{frame + 5, height}, {frame + 7, width}}) {
        bytes[at] = static_cast<std::byte>(value >> 8);
        bytes[at + 1] = static_cast<std::byte>(value & 0xff);
    }
}

TEST(DecodeImage, ReadsJpegOfEveryColourSpace) {
    for (const bool progressive : {false, true}) {
        expectColor(decodeImage(jpeg(20, 9, JCS_RGB, {200, 100, 50}, progressive), true),
                    {200, 100, 50, 255});
        expectColor(decodeImage(jpeg(17, 3, JCS_GRAYSCALE, {77}, progressive), true), {77, 77, 77, 255});
        // As Adobe's, where 255 is no ink.
        expectColor(decodeImage(jpeg(8, 8, JCS_CMYK, {255, 128, 0, 128}, progressive), true),
                    {128, 64, 0, 255});
    }
}

TEST(DecodeImage, RefusesJpegThatIsCutShortOrDamaged) {
    Bytes bytes = jpeg(64, 64, JCS_RGB, {200, 100, 50});
    Bytes cut(bytes.begin(), bytes.end() - 40);
    expectRefused(cut, "the JPEG cannot be decoded: ");
    cut.resize(100);
    expectRefused(cut, "the JPEG cannot be decoded: ");
}

// stb_image 2.27 wrote past its tables here.
TEST(DecodeImage, RefusesHuffmanTablesOfTooManyCodes) {
    Bytes bytes = jpeg(16, 16, JCS_RGB, {1, 2, 3});
    const size_t table = find(bytes, {0xff, 0xc4});
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(table + 5), 16, std::byte{255});
    expectRefused(bytes, "Huffman");
}

TEST(DecodeImage, RefusesImagesThatTheirBytesCannotHoldBeforeTakingMemory) {
    Bytes baseline = jpeg(16, 16, JCS_RGB, {1, 2, 3});
    claim(baseline, 0xc0, 16000, 16000);
    expectRefused(baseline, "cannot hold its 16000 x 16000 texels");
    Bytes progressive = jpeg(16, 16, JCS_RGB, {1, 2, 3}, true);
    claim(progressive, 0xc2, 65500, 65500);
    expectRefused(progressive, "at most");

    Bytes png = encodePng(2, 2, 4, 8, std::vector<uint16_t>(16, 9));
    png[16 + 2] = std::byte{0x3f};  // width and height stand behind signature, length and type
    png[20 + 2] = std::byte{0x3f};
    expectRefused(png, "cannot hold its 16130 x 16130 texels");
}

TEST(DecodeImage, RefusesScansWithoutEnd) {
    Bytes bytes = jpeg(16, 16, JCS_RGB, {1, 2, 3}, true);
    const size_t scan = find(bytes, {0xff, 0xda});
    const size_t next =
        scan + 2 +
        find(Bytes(bytes.begin() + static_cast<std::ptrdiff_t>(scan + 2), bytes.end()), {0xff, 0xc4});
    const Bytes again(bytes.begin() + static_cast<std::ptrdiff_t>(scan),
                      bytes.begin() + static_cast<std::ptrdiff_t>(next));
    for (int i = 0; i < 200; ++i)
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(next), again.begin(), again.end());
    expectRefused(bytes, "more than 100 scans");
}

TEST(DecodeImage, ReadsPngOfEveryDepthExactly) {
    const std::vector<uint16_t> small{10, 20, 30, 250, 240, 230};
    const Image rgb = decodeImage(encodePng(2, 1, 3, 8, small), true);
    EXPECT_THAT(rgb.rgba8, testing::ElementsAre(10, 20, 30, 255, 250, 240, 230, 255));
    const Image rgba = decodeImage(encodePng(1, 1, 4, 8, {1, 2, 3, 4}), true);
    EXPECT_THAT(rgba.rgba8, testing::ElementsAre(1, 2, 3, 4));
    const Image deep = decodeImage(encodePng(1, 1, 4, 16, {0, 65535, 256, 32768}), false);
    EXPECT_THAT(deep.rgbaFloat, testing::ElementsAre(0, 1, 256 / 65535.0f, 32768 / 65535.0f));
    EXPECT_TRUE(deep.rgba8.empty());
    const Image linear = decodeImage(encodePng(1, 1, 3, 16, {65535, 32768, 0}), true);
    EXPECT_THAT(linear.rgbaFloat, testing::ElementsAre(1, testing::FloatNear(0.21404f, 1e-5f), 0, 1));
}

TEST(DecodeImage, ReadsPngWithAWrongCheckSumAndRefusesOneCutShort) {
    Bytes png = encodePng(2, 2, 3, 8, std::vector<uint16_t>(12, 9));
    png[29] ^= std::byte{1};  // of the header
    EXPECT_EQ(decodeImage(png, true).rgba8[0], 9);
    png.resize(png.size() - 24);
    expectRefused(png, "the PNG cannot be decoded: ");
}

TEST(DecodeImage, RefusesWhatIsNeither) {
    expectRefused({}, "neither PNG nor JPEG");
    expectRefused(Bytes(100, std::byte{'x'}), "neither PNG nor JPEG");
}

}  // namespace
}  // namespace tilefarm
