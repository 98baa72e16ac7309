#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

namespace tilefarm {

inline constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

enum class Wrap : uint32_t { repeat, mirror, clamp };

/// How a material reads an image. The transform is KHR_texture_transform's: uv' = matrix * (uv, 1).
struct TextureRef {
    uint32_t image = kNone;
    uint32_t uvSet = 0;  // 0 or 1
    Wrap wrapS = Wrap::repeat, wrapT = Wrap::repeat;
    bool linearFilter = true;
    bool srgb = false;                        // texels are sRGB-encoded; decoded before filtering
    glm::mat3x2 transform{1, 0, 0, 1, 0, 0};  // columns: d/du, d/dv, offset
    explicit operator bool() const { return image != kNone; }
};

}  // namespace tilefarm
