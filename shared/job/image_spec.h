#pragma once

#include <cstdint>

namespace tilefarm {

struct ImageSpec {
    uint32_t width = 0;   // pixels; 0: open until pictureSize (shared/gltf) says it by the camera's aspect
    uint32_t height = 0;  // pixels; likewise
    uint32_t tileSize = 128;  // pixels, 8 … 1024, a multiple of 8; never changes the pixels' bits
    friend bool operator==(const ImageSpec&, const ImageSpec&) = default;
};

}  // namespace tilefarm
