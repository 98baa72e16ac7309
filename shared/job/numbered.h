#pragma once

#include <cstdint>
#include <filesystem>

namespace tilefarm {

/// The file for one frame of several: a run of '#' is its number, else the number stands before the suffix.
std::filesystem::path numbered(const std::filesystem::path& path, int32_t frame);

}  // namespace tilefarm
