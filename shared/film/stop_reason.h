#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tilefarm {

struct StopCondition;

/// Which condition completed a frame.
enum class StopReason { samples, relativeError, deviceSeconds, wallSeconds };

/// The name of the member of StopCondition.
std::string_view toString(StopReason reason);
/// Throws Error(internal) on a word that names none.
StopReason stopReasonFrom(std::string_view word);

/// For people: "error target of 0.05 reached at 96 samples per pixel".
std::string sentenceOf(StopReason reason, const StopCondition& stop, uint32_t samples);

}  // namespace tilefarm
