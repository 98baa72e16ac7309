#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "worker/scene/json_node.h"

namespace tilefarm {

bool isDataUri(std::string_view uri);
/// The bytes of a data URI, base64 or percent-encoded. Faults are reported at `node`.
std::vector<std::byte> decodeDataUri(std::string_view uri, const JsonNode& node);

/// The relative path that a uri names, percent-decoded. What is absolute, has a scheme or leads out of
/// the folder with ".." is an error: a scene must not read other files of the machine.
std::filesystem::path relativePathOf(const JsonNode& uri);

}  // namespace tilefarm
