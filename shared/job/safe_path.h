#pragma once

#include <string>
#include <string_view>

namespace tilefarm {

/// Why a path of a scene bundle must not be used, or an empty text. Good paths are relative, split by
/// '/', stay inside their folder on every system ("..", drive letters, backslashes and control
/// characters are refused), and are not too long for one.
std::string pathFault(std::string_view path);

/// True if `path` ends with `suffix`, ASCII letters of either case being the same.
bool hasSuffix(std::string_view path, std::string_view suffix);

}  // namespace tilefarm
