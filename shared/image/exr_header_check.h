#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace tilefarm {

// What a reader of EXR takes, so that a header of a few bytes cannot ask for all memory. Deflate reaches
// 1032:1 at most; other methods stay below twice that on whole files.
inline constexpr int64_t kLargestExrSide = 65536;
inline constexpr uint64_t kMostExrExpansion = 2048;

/// Goes through the headers of an EXR as OpenEXR will, before it does: OpenEXR takes memory for whatever
/// sizes stand there before it looks whether the file has as much. Gives how many headers there are. Throws
/// std::runtime_error that names the fault.
size_t requireHonestExrHeaders(std::span<const std::byte> bytes);

}  // namespace tilefarm
