#include "shared/image/png.h"

#include <gtest/gtest.h>

#include "shared/file/durable_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

uint32_t bigEndian(const std::vector<std::byte>& bytes, size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<uint32_t>(bytes.at(at + i));
    return value;
}

TEST(Png, IsAnEightBitRgbImageOfTheRightSize) {
    const RgbImage image{5, 3, std::vector<unsigned char>(45, 200)};
    const std::vector<std::byte> png = encodePng(image);
    EXPECT_EQ(bigEndian(png, 0), 0x89504E47u);  // signature
    EXPECT_EQ(bigEndian(png, 16), 5u);
    EXPECT_EQ(bigEndian(png, 20), 3u);
    EXPECT_EQ(std::to_integer<int>(png[24]), 8);             // bits
    EXPECT_EQ(std::to_integer<int>(png[25]), 2);             // truecolour
    EXPECT_EQ(bigEndian(png, png.size() - 8), 0x49454E44u);  // IEND
}

TEST(Png, IsWrittenWhole) {
    const TemporaryFolder folder;
    const RgbImage image{2, 2, std::vector<unsigned char>(12, 7)};
    writePng(folder / "a.png", image);
    EXPECT_EQ(readWhole(folder / "a.png"), encodePng(image));
    EXPECT_EQ(codeOf([&] { writePng(folder / "no/a.png", image); }), ErrorCode::notFound);
}

TEST(Png, RefusesPixelsThatDoNotFillTheImage) {
    EXPECT_EQ(codeOf([] { encodePng({2, 2, std::vector<unsigned char>(11)}); }), ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([] { encodePng({0, 0, {}}); }), ErrorCode::invalidArgument);
}

TEST(ToneMapped, KeepsChannelsAndRowsInTheirPlace) {
    const FloatImage image{2, 1, {"B", "A", "R", "G"}, {{0, 0}, {1, 1}, {1, 0}, {0, 1}}};
    const RgbImage shown = toneMapped(image, {ToneCurve::linear, 0});
    EXPECT_EQ(shown.pixels, (std::vector<unsigned char>{255, 0, 0, 0, 255, 0}));
    EXPECT_EQ(codeOf([] { toneMapped({1, 1, {"R", "G"}, {{0}, {0}}}, {}); }), ErrorCode::invalidArgument);
}

}  // namespace
}  // namespace tilefarm
