#include <gtest/gtest.h>

#include "server/cli/commands.h"

namespace tilefarm {
namespace {

TEST(Numbered, PutsTheFrameWhereTheHashesAreOrBeforeTheSuffix) {
    EXPECT_EQ(numbered("a/out.exr", 7), "a/out.0007.exr");
    EXPECT_EQ(numbered("a/o-######.exr", 7), "a/o-000007.exr");
    EXPECT_EQ(numbered("#.png", 123), "123.png");
    EXPECT_EQ(numbered("out##", 5), "out05");
    EXPECT_EQ(numbered("a.b.exr", 12345), "a.b.12345.exr");
}

}  // namespace
}  // namespace tilefarm
