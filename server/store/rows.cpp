#include "server/store/rows.h"

#include <array>
#include <utility>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

template <typename State>
using Words = std::pair<State, std::string_view>;

constexpr std::array kFrameWords{Words<FrameState>{FrameState::active, "active"},
                                 Words<FrameState>{FrameState::finishing, "finishing"},
                                 Words<FrameState>{FrameState::completed, "completed"}};
constexpr std::array kLeaseWords{
    Words<LeaseState>{LeaseState::open, "open"},       Words<LeaseState>{LeaseState::merged, "merged"},
    Words<LeaseState>{LeaseState::expired, "expired"}, Words<LeaseState>{LeaseState::returned, "returned"},
    Words<LeaseState>{LeaseState::failed, "failed"},   Words<LeaseState>{LeaseState::revoked, "revoked"}};
constexpr std::array kLossWords{Words<Loss>{Loss::none, "none"}, Words<Loss>{Loss::counted, "counted"},
                                Words<Loss>{Loss::shared, "shared"}};
constexpr std::array kWorkerWords{Words<WorkerState>{WorkerState::online, "online"},
                                  Words<WorkerState>{WorkerState::draining, "draining"},
                                  Words<WorkerState>{WorkerState::parked, "parked"},
                                  Words<WorkerState>{WorkerState::quarantined, "quarantined"},
                                  Words<WorkerState>{WorkerState::offline, "offline"}};
constexpr std::array kStudyWords{
    Words<StudyState>{StudyState::running, "running"}, Words<StudyState>{StudyState::completed, "completed"},
    Words<StudyState>{StudyState::failed, "failed"}, Words<StudyState>{StudyState::canceled, "canceled"}};

template <typename Table, typename State>
std::string_view wordOf(const Table& table, State state) {
    for (const auto& [value, word] : table) {
        if (value == state) return word;
    }
    throw Error(ErrorCode::internal, "a state without a word");
}

template <typename Table>
auto stateOf(const Table& table, std::string_view wanted) {
    for (const auto& [value, word] : table) {
        if (word == wanted) return value;
    }
    throw Error(ErrorCode::internal, "the database holds the unknown state '" + std::string(wanted) + "'");
}

}  // namespace

void LevelRow::addSums(const LevelRow& other) {
    relativeVariance += other.relativeVariance;
    errorSquares += other.errorSquares;
    borrowedVariance += other.borrowedVariance;
    errorTail.add(other.errorTail);
    droppedSamples += other.droppedSamples;
}

std::string stopSentence(const FrameRow& frame, const StopCondition& stop) {
    return frame.stopReason ? sentenceOf(*frame.stopReason, stop, frame.samplesMerged) : std::string();
}

std::string_view toString(FrameState state) {
    return wordOf(kFrameWords, state);
}
std::string_view toString(LeaseState state) {
    return wordOf(kLeaseWords, state);
}
std::string_view toString(Loss loss) {
    return wordOf(kLossWords, loss);
}
std::string_view toString(WorkerState state) {
    return wordOf(kWorkerWords, state);
}
std::string_view toString(StudyState state) {
    return wordOf(kStudyWords, state);
}
FrameState frameStateFrom(std::string_view word) {
    return stateOf(kFrameWords, word);
}
LeaseState leaseStateFrom(std::string_view word) {
    return stateOf(kLeaseWords, word);
}
Loss lossFrom(std::string_view word) {
    return stateOf(kLossWords, word);
}
WorkerState workerStateFrom(std::string_view word) {
    return stateOf(kWorkerWords, word);
}
StudyState studyStateFrom(std::string_view word) {
    return stateOf(kStudyWords, word);
}

}  // namespace tilefarm
