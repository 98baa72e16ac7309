#include "shared/film/stop_reason.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "shared/error/error.h"
#include "shared/job/job.h"

namespace tilefarm {
namespace {

constexpr std::array kReasonWords{std::pair{StopReason::samples, std::string_view("samples")},
                                  std::pair{StopReason::relativeError, std::string_view("relativeError")},
                                  std::pair{StopReason::deviceSeconds, std::string_view("deviceSeconds")},
                                  std::pair{StopReason::wallSeconds, std::string_view("wallSeconds")}};

std::string limitOf(StopReason reason, const StopCondition& stop, uint32_t samples) {
    switch (reason) {
        case StopReason::deviceSeconds:
            return fmt::format("limit of {} device seconds reached at {} samples per pixel",
                               stop.deviceSeconds, samples);
        case StopReason::wallSeconds:
            return fmt::format("limit of {} seconds reached at {} samples per pixel", stop.wallSeconds,
                               samples);
        default: return fmt::format("sample limit of {} reached", stop.samples);
    }
}

}  // namespace

std::string_view toString(StopReason reason) {
    for (const auto& [value, word] : kReasonWords)
        if (value == reason) return word;
    throw Error(ErrorCode::internal, "a stop reason without a word");
}

StopReason stopReasonFrom(std::string_view wanted) {
    for (const auto& [value, word] : kReasonWords)
        if (word == wanted) return value;
    throw Error(ErrorCode::internal, "the unknown stop reason '" + std::string(wanted) + "'");
}

std::string sentenceOf(StopReason reason, const StopCondition& stop, uint32_t samples) {
    if (reason == StopReason::relativeError)
        return fmt::format("error target of {} reached at {} samples per pixel", stop.relativeError, samples);
    if (!stop.decidesOnTheWay()) return fmt::format("all {} samples per pixel taken", stop.samples);
    std::string sentence = limitOf(reason, stop, samples);
    if (stop.relativeError > 0) sentence += fmt::format(" before the error target of {}", stop.relativeError);
    return sentence;
}

}  // namespace tilefarm
