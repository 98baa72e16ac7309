#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "shared/job/bundle_paths.h"
#include "worker/scene/json_node.h"

namespace tilefarm {

/// In capitals too.
bool isDataUri(std::string_view uri);
/// The bytes of a data URI, base64 or percent-encoded. Faults are reported at `node`.
std::vector<std::byte> decodeDataUri(std::string_view uri, const JsonNode& node);

/// The relative path that a uri names, percent-decoded. What is absolute, has a scheme or leads more than
/// `levelsUp` folders above the scene's is an error: a scene must not read other files of the machine.
TidyPath relativePathOf(const JsonNode& uri, size_t levelsUp);

}  // namespace tilefarm
