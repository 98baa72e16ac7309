#include "shared/job/states.h"

#include <string>

#include "shared/error/error.h"

namespace tilefarm {

namespace {

template <typename State>
struct Word {
    State state;
    std::string_view word;
};
template <typename State>
Word(State, std::string_view) -> Word<State>;  // implied since C++20, but not yet to clang 14

constexpr std::array kJobWords{
    Word{JobState::queued, "queued"}, Word{JobState::running, "running"},
    Word{JobState::paused, "paused"}, Word{JobState::completed, "completed"},
    Word{JobState::failed, "failed"}, Word{JobState::canceled, "canceled"},
};
constexpr std::array kPassWords{
    Word{PassState::queued, "queued"},
    Word{PassState::leased, "leased"},
    Word{PassState::merged, "merged"},
    Word{PassState::failed, "failed"},
};

std::string_view wordOf(const auto& words, auto state) {
    for (const auto& w : words)
        if (w.state == state) return w.word;
    throw Error(ErrorCode::internal, "a state without a word");
}

auto stateOf(const auto& words, std::string_view word, const char* kind) {
    std::string known;
    for (const auto& w : words) {
        if (w.word == word) return w.state;
        known += (known.empty() ? "" : ", ") + std::string(w.word);
    }
    throw Error(ErrorCode::invalidArgument,
                "'" + std::string(word) + "' is no " + kind + " state; there are " + known);
}

}  // namespace

std::string_view toString(JobState state) {
    return wordOf(kJobWords, state);
}
std::string_view toString(PassState state) {
    return wordOf(kPassWords, state);
}
JobState jobStateFrom(std::string_view word) {
    return stateOf(kJobWords, word, "job");
}
PassState passStateFrom(std::string_view word) {
    return stateOf(kPassWords, word, "pass");
}

}  // namespace tilefarm
