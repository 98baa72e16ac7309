#include "worker/render/table_cache.h"

#include <fmt/core.h>

#include <cstring>
#include <span>

#include "shaders/gpu_types.h"
#include "worker/cache_file/computed_cache.h"
#include "worker/vk/device.h"

namespace tilefarm {

std::vector<glm::vec4> tableOnce(std::string_view key,
                                 const std::function<std::vector<glm::vec4>()>& integrate) {
    const std::string whole = fmt::format("{} {} {}", TILEFARM_TABLE_SOURCES, gpu::ALBEDO_TABLE_SIZE, key);
    const auto compute = [&] {
        const std::vector<glm::vec4> texels = integrate();
        const auto bytes = std::as_bytes(std::span(texels));
        return std::vector<std::byte>(bytes.begin(), bytes.end());
    };
    const std::vector<std::byte> bytes =
        computedOnce({gpu::shaderCacheFolder()}, "table", std::as_bytes(std::span(whole)), compute);
    std::vector<glm::vec4> texels(bytes.size() / sizeof(glm::vec4));
    std::memcpy(texels.data(), bytes.data(), texels.size() * sizeof(glm::vec4));
    return texels;
}

}  // namespace tilefarm
