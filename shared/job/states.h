#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace tilefarm {

enum class JobState { queued, running, paused, completed, failed, canceled };
enum class PassState { queued, leased, merged, failed };

template <typename State>
struct Transition {
    State from, to;
};
template <typename State>
Transition(State, State) -> Transition<State>;  // implied since C++20, but not yet to clang 14

/// Every move there is. server/queue is the only mover; the same rules stand in SQL as triggers.
inline constexpr std::array kJobTransitions{
    Transition{JobState::queued, JobState::running},  // its first pass is leased
    Transition{JobState::queued, JobState::paused},     Transition{JobState::queued, JobState::canceled},
    Transition{JobState::running, JobState::completed},  // its last pass is merged
    Transition{JobState::running, JobState::failed},     // a pass failed
    Transition{JobState::running, JobState::paused},    Transition{JobState::running, JobState::canceled},
    Transition{JobState::paused, JobState::queued},     // resumed before it had begun
    Transition{JobState::paused, JobState::running},    // resumed
    Transition{JobState::paused, JobState::completed},  // the last leased pass came in meanwhile
    Transition{JobState::paused, JobState::failed},     Transition{JobState::paused, JobState::canceled},
};

inline constexpr std::array kPassTransitions{
    Transition{PassState::queued, PassState::leased},  // a worker takes it
    Transition{PassState::queued, PassState::merged},  // a late result of an expired lease came in
    Transition{PassState::leased, PassState::queued},  // lease expired, handed back, or a retry is left
    Transition{PassState::leased, PassState::merged},
    Transition{PassState::leased, PassState::failed},  // several distinct workers reported an error
};

constexpr bool canMove(JobState from, JobState to) {
    return std::any_of(kJobTransitions.begin(), kJobTransitions.end(),
                       [&](const auto& t) { return t.from == from && t.to == to; });
}
constexpr bool canMove(PassState from, PassState to) {
    return std::any_of(kPassTransitions.begin(), kPassTransitions.end(),
                       [&](const auto& t) { return t.from == from && t.to == to; });
}
constexpr bool isFinal(JobState state) {
    return state == JobState::completed || state == JobState::failed || state == JobState::canceled;
}

static_assert(!canMove(PassState::merged, PassState::queued), "merged samples are never given up");
static_assert(!canMove(JobState::canceled, JobState::running), "a canceled job stays canceled");

std::string_view toString(JobState state);
std::string_view toString(PassState state);
/// Throw Error(invalidArgument) on a word that names no state.
JobState jobStateFrom(std::string_view word);
PassState passStateFrom(std::string_view word);

}  // namespace tilefarm
