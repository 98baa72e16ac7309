#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace tilefarm {

/// String attributes of an image file, by their names without "tilefarm.".
using ImageAttributes = std::map<std::string, std::string>;

inline constexpr std::string_view kAttributePrefix = "tilefarm.";

/// The longest value of a header entry that we write: after an entry of more than 255 bytes ffmpeg 5.1.9 may
/// lose its place in the header and give a black picture (findings/ffmpeg-exr-attributes.sh).
inline constexpr size_t kMostAttributeBytes = 250;

/// A text that is longer becomes "NAME.001", "NAME.002", … which go on where the last ended, between
/// characters of UTF-8; any other stays "NAME".
std::map<std::string, std::string> splitAttribute(const std::string& name, std::string_view text);
/// Undoes splitAttribute on all entries.
ImageAttributes joinAttributes(const ImageAttributes& entries);

}  // namespace tilefarm
