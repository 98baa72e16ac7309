#include "shared/film/error_tail.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

ErrorTail tailOf(const std::vector<WorstPixel>& pixels) {
    ErrorTail tail;
    for (const WorstPixel& pixel : pixels) tail.add(pixel);
    return tail;
}

TEST(ErrorTail, NamesTheWorstPixelsWhateverTheOrder) {
    std::vector<WorstPixel> pixels;
    for (uint32_t i = 0; i < 40; ++i) pixels.push_back({i, 7, 1.0 + i / 4});  // four of a kind
    const ErrorTail tail = tailOf(pixels);
    ASSERT_EQ(tail.worst().size(), kMostWorstPixels);
    EXPECT_EQ(tail.worst().front(), (WorstPixel{36, 7, 10}));
    EXPECT_EQ(tail.worst().back(), (WorstPixel{27, 7, 7}));

    ErrorTail joined = tailOf({pixels.begin() + 20, pixels.end()});
    joined.add(tailOf({pixels.begin(), pixels.begin() + 20}));
    EXPECT_EQ(joined.worst(), tail.worst());
}

TEST(ErrorTail, GivesTheShareOfTheWorst) {
    EXPECT_EQ(ErrorTail().shareOfWorst(3), 0);
    const ErrorTail tail = tailOf({{0, 0, 64}, {1, 0, 16}, {2, 0, 16}, {3, 0, 4}});
    EXPECT_EQ(tail.shareOfWorst(1), 0.64);
    EXPECT_EQ(tail.shareOfWorst(2), 0.80);  // of two equal ones one
    EXPECT_EQ(tail.shareOfWorst(9), 1);
}

TEST(ErrorTail, LeavesOutWhatIsNoErrorAndKeepsTheExtremes) {
    const ErrorTail tail = tailOf({{0, 0, 0}, {1, 0, 1. / 0.}, {2, 0, 1e-300}, {3, 0, 1e300}});
    ASSERT_EQ(tail.worst().size(), 2u);
    EXPECT_EQ(tail.shareOfWorst(1), 1);
}

TEST(ErrorTail, ComesBackFromItsText) {
    const ErrorTail tail = tailOf({{3, 4, 0.1}, {5, 6, 1. / 3}, {4000000000u, 1, 1e-9}});
    EXPECT_EQ(ErrorTail::parse(tail.text()), tail);
    EXPECT_EQ(ErrorTail::parse(""), ErrorTail());
    for (const char* text : {"pixel 1 2", "octave 64 1 1", "edge 1 2 3", "pixel a b c"})
        EXPECT_EQ(codeOf([&] { ErrorTail::parse(text); }), ErrorCode::internal) << text;
}

}  // namespace
}  // namespace tilefarm
