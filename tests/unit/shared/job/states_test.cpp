#include <gtest/gtest.h>

#include "shared/job/states.h"
#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

constexpr std::array kJobStates{JobState::queued,    JobState::running, JobState::paused,
                                JobState::completed, JobState::failed,  JobState::canceled};
constexpr std::array kPassStates{PassState::queued, PassState::leased, PassState::merged, PassState::failed};

TEST(States, EveryWordNamesItsState) {
    for (const JobState state : kJobStates) EXPECT_EQ(jobStateFrom(toString(state)), state);
    for (const PassState state : kPassStates) EXPECT_EQ(passStateFrom(toString(state)), state);
}

TEST(States, AnUnknownWordIsRefusedWithTheKnownOnes) {
    const Error error = errorOf([] { jobStateFrom("cancelled"); });
    EXPECT_EQ(error.code, ErrorCode::invalidArgument);
    EXPECT_NE(std::string(error.what()).find("'cancelled'"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("canceled"), std::string::npos);
    EXPECT_EQ(codeOf([] { passStateFrom(""); }), ErrorCode::invalidArgument);
}

TEST(States, NothingLeavesAFinalState) {
    for (const JobState from : kJobStates)
        for (const JobState to : kJobStates)
            if (isFinal(from)) {
                EXPECT_FALSE(canMove(from, to)) << toString(from) << " -> " << toString(to);
            }
}

TEST(States, EveryJobThatIsNotFinalCanBeCanceled) {
    for (const JobState from : kJobStates) EXPECT_EQ(canMove(from, JobState::canceled), !isFinal(from));
}

TEST(States, AMergedPassStaysMerged) {
    for (const PassState to : kPassStates) EXPECT_FALSE(canMove(PassState::merged, to));
}

TEST(States, NoStateMovesToItself) {
    for (const JobState state : kJobStates) EXPECT_FALSE(canMove(state, state));
    for (const PassState state : kPassStates) EXPECT_FALSE(canMove(state, state));
}

}  // namespace
}  // namespace tilefarm
