#include "shared/job/frames.h"

#include <gtest/gtest.h>

#include "shared/error/error.h"
#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

using Numbers = std::vector<int32_t>;

TEST(Frames, AreOneOrARange) {
    EXPECT_EQ(framesFrom("7"), (FrameSet{7, 1}));
    EXPECT_EQ(framesFrom("1-240"), (FrameSet{1, 240}));
    EXPECT_EQ(framesFrom("-5--1"), (FrameSet{-5, 5}));
    EXPECT_EQ(framesFrom("-5-5"), (FrameSet{-5, 11}));
}

TEST(Frames, OfARangeMayBeSteps) {
    EXPECT_EQ(framesFrom("1-100x10"), (FrameSet{1, 10, 10}));
    EXPECT_EQ(frameNumbers({1, 4, 10}), (Numbers{1, 11, 21, 31}));
    EXPECT_EQ(frameNumbers(framesFrom("1-10x4")), (Numbers{1, 5, 9}));
    EXPECT_EQ(frameNumbers(framesFrom("-9-0x9")), (Numbers{-9, 0}));
    EXPECT_EQ(framesFrom("3-5x7"), (FrameSet{3, 1})) << "a single frame has no step";
}

TEST(Frames, OfAListComeInItsOrderAndOnce) {
    EXPECT_EQ(framesFrom("1,5,9"), (FrameSet{1, 3, 1, "1,5,9"}));
    EXPECT_EQ(framesFrom(" 1-9x4 , 20-21"), (FrameSet{1, 5, 1, "1-9x4,20-21"}));
    EXPECT_EQ(frameNumbers(framesFrom("1-9x4,1-3")), (Numbers{1, 5, 9, 2, 3})) << "coarse first";
    EXPECT_EQ(framesFrom("1-9x4,1-3").count, 5u);
    EXPECT_EQ(sortedFrameNumbers(framesFrom("9,1-3,-4")), (Numbers{-4, 1, 2, 3, 9}));
}

TEST(Frames, WrittenAsTextAreTheSame) {
    for (const char* text : {"7", "-5--1", "1-91x10", "1,5,9", "2147483647,-2147483648", "1-9x4,20-21"})
        EXPECT_EQ(textOf(framesFrom(text)), text);
}

TEST(Frames, AreRefusedWithWhatTheyShouldBe) {
    for (const char* bad :
         {"", "5-4", "1-", "-", "1-2-3", "1..2", "0-100000", "2147483648", "9999999999999999999", "1,", ",1",
          "1,,2", "1-9x0", "1x2", "1-9x", "1-9x-2", "0-50000,50001-100001", "1;2"})
        EXPECT_EQ(errorOf([&] { framesFrom(bad); }).code, ErrorCode::invalidArgument) << bad;
    EXPECT_EQ(framesFrom("0-50000,50001-99999").count, kMostFrames);
    std::string again = "0-99999";
    for (int i = 0; i < 4; ++i) again += ",0-99999";
    EXPECT_EQ(errorOf([&] { framesFrom(again); }).code, ErrorCode::invalidArgument);
}

}  // namespace
}  // namespace tilefarm
