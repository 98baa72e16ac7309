#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "shaders/gpu_types.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// Collects the textures that materials refer to: images once each, records once per way of reading.
class TexturePacker {
public:
    explicit TexturePacker(const Scene& scene);

    /// Index of the record for `ref`, NO_INDEX for none.
    uint32_t add(const TextureRef& ref);

    std::vector<gpu::TextureRecord> records;
    std::vector<uint8_t> texels8;  // RGBA
    std::vector<float> texels32;   // RGBA
    std::vector<uint32_t> images;  // of the scene, in the order of their texels
    /// What the added textures call for: FEATURE_* of filtering, transforms, UV sets and formats.
    uint64_t features = 0;

private:
    uint32_t firstTexelOf(uint32_t image);

    const Scene& scene_;
    std::map<uint32_t, uint32_t> firstTexel_;
};

}  // namespace tilefarm
