#include "server/cli/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/fake_clock.h"

namespace tilefarm {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct ProgressTest : testing::Test {
    FakeClock clock;
    std::ostringstream out, err;
    Console consoleFor(bool terminal) {
        return {out, err, terminal, clock, [](Milliseconds) {}};
    }

    static JobProgress at(double fraction, const char* state = "running") {
        JobProgress p;
        p.state = state, p.fraction = fraction;
        p.samples = static_cast<uint64_t>(64 * fraction), p.samplesWanted = 64;
        p.relativeError = 0.0625;
        return p;
    }
    size_t lines() const {
        const std::string text = err.str();
        return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
    }
};

TEST_F(ProgressTest, WritesAPlainLinePerStepAndState) {
    const Console console = consoleFor(false);
    ProgressLine line(console);
    line.show(at(0, "queued"));
    line.show(at(0, "queued"));
    EXPECT_EQ(lines(), 1u);
    line.show(at(0.01));  // another state
    EXPECT_EQ(lines(), 2u);
    line.show(at(0.05));
    EXPECT_EQ(lines(), 2u);
    line.show(at(0.07));  // over 5 %
    EXPECT_EQ(lines(), 3u);
    line.show(at(0.08));
    clock.advance(10s);
    line.show(at(0.07));  // long ago, but nothing new
    EXPECT_EQ(lines(), 3u);
    line.show(at(0.09));
    EXPECT_EQ(lines(), 4u);
    EXPECT_THAT(err.str(), Not(HasSubstr("\r")));
}

TEST_F(ProgressTest, SaysWhatThereIsToSay) {
    const Console console = consoleFor(false);
    ProgressLine line(console);
    JobProgress p = at(0.5);
    p.frames = 3, p.framesDone = 1;
    line.show(p);
    EXPECT_EQ(err.str(), " 50 %  running  frame 2 of 3  32 of 64 samples  relative error 0.0625\n");
}

TEST_F(ProgressTest, RedrawsABarOnATerminalAndEndsItsLine) {
    {
        const Console console = consoleFor(true);
        ProgressLine line(console);
        line.show(at(0.5));
        line.show(at(0.75));
        EXPECT_EQ(lines(), 0u);
        EXPECT_THAT(err.str(), HasSubstr("\r[============            ]  50 %"));
        EXPECT_THAT(err.str(), HasSubstr("\r[==================      ]  75 %"));
        line.note("a remark");
        EXPECT_THAT(err.str(), HasSubstr("\na remark\n"));
        line.show(at(1, "completed"));
    }
    EXPECT_EQ(err.str().back(), '\n');
}

TEST_F(ProgressTest, BlanksWhatALongerLineLeftBehind) {
    const Console console = consoleFor(true);
    ProgressLine line(console);
    line.show(at(0.5));
    const size_t width = err.str().size() - 1;
    err.str("");
    JobProgress shorter = at(0.5);
    shorter.relativeError.reset();
    line.show(shorter);
    EXPECT_EQ(err.str().size() - 1, width);
}

TEST_F(ProgressTest, PredictsFromThePaceOfTheLastHalfMinute) {
    Eta eta;
    eta.add(clock.time, 0);
    EXPECT_FALSE(eta.left());
    clock.advance(10s);
    eta.add(clock.time, 0);
    EXPECT_FALSE(eta.left());  // nothing has moved yet
    clock.advance(10s);
    eta.add(clock.time, 0.1);
    EXPECT_EQ(eta.left(), 180s);
    for (int i = 0; i < 40; ++i) {  // ten times as fast: the slow start is forgotten
        clock.advance(1s);
        eta.add(clock.time, 0.1 + 0.01 * (i + 1));
    }
    EXPECT_EQ(eta.left(), 50s);
}

TEST_F(ProgressTest, ShowsTheTimeLeftOnlyWhileSomethingMoves) {
    const Console console = consoleFor(false);
    ProgressLine line(console);
    line.show(at(0.1));
    clock.advance(60s);
    line.show(at(0.4));
    EXPECT_THAT(err.str(), HasSubstr("2:00 left"));
    err.str("");
    line.show(at(0.5, "paused"));
    EXPECT_THAT(err.str(), Not(HasSubstr("left")));
}

TEST(ClockFace, IsReadableAtEveryLength) {
    EXPECT_EQ(clockFace(7s), "0:07");
    EXPECT_EQ(clockFace(750s), "12:30");
    EXPECT_EQ(clockFace(11100s), "3:05:00");
}

}  // namespace
}  // namespace tilefarm
