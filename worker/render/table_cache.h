#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

namespace tilefarm {

/// A table that takes tenths of a second to integrate, kept in gpu::shaderCacheFolder() from run to run.
/// `key` names the table and its parameters; the sources that integrate are part of what it is kept by.
std::vector<glm::vec4> tableOnce(std::string_view key,
                                 const std::function<std::vector<glm::vec4>()>& integrate);

}  // namespace tilefarm
