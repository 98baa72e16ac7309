#include "worker/render/texture_packer.h"

#include <cstring>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

bool same(const gpu::TextureRecord& a, const gpu::TextureRecord& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

uint32_t flagsOf(const TextureRef& ref, bool isFloat) {
    uint32_t flags = static_cast<uint32_t>(ref.wrapS) << gpu::TEXTURE_WRAP_S_SHIFT |
                     static_cast<uint32_t>(ref.wrapT) << gpu::TEXTURE_WRAP_T_SHIFT;
    if (ref.linearFilter) flags |= gpu::TEXTURE_LINEAR_FILTER;
    if (ref.srgb) flags |= gpu::TEXTURE_SRGB;
    if (ref.uvSet == 1) flags |= gpu::TEXTURE_UV1;
    if (isFloat) flags |= gpu::TEXTURE_FLOAT;
    if (ref.transform != glm::mat3x2(1, 0, 0, 1, 0, 0)) flags |= gpu::TEXTURE_TRANSFORM;
    return flags;
}

uint64_t featuresOf(uint32_t flags) {
    uint64_t features = 0;
    if ((flags & gpu::TEXTURE_LINEAR_FILTER) == 0) features |= gpu::bit(gpu::FEATURE_NEAREST_FILTER);
    if ((flags & gpu::TEXTURE_UV1) != 0) features |= gpu::bit(gpu::FEATURE_SECOND_UV_SET);
    if ((flags & gpu::TEXTURE_FLOAT) != 0) features |= gpu::bit(gpu::FEATURE_FLOAT_TEXTURES);
    if ((flags & gpu::TEXTURE_TRANSFORM) != 0) features |= gpu::bit(gpu::FEATURE_TEXTURE_TRANSFORMS);
    return features;
}

}  // namespace

TexturePacker::TexturePacker(const Scene& scene) : scene_(scene) {}

uint32_t TexturePacker::firstTexelOf(uint32_t image) {
    if (const auto known = firstTexel_.find(image); known != firstTexel_.end()) return known->second;
    const Image& source = scene_.images[image];
    const bool isFloat = !source.rgbaFloat.empty();
    const size_t first = (isFloat ? texels32.size() : texels8.size()) / 4;
    if (first + size_t{source.width} * source.height > 0x7fffffffu)
        throw Error(ErrorCode::unprocessable, "the scene's textures have more than 2^31 texels");
    if (isFloat)
        texels32.insert(texels32.end(), source.rgbaFloat.begin(), source.rgbaFloat.end());
    else
        texels8.insert(texels8.end(), source.rgba8.begin(), source.rgba8.end());
    images.push_back(image);
    return firstTexel_[image] = static_cast<uint32_t>(first);
}

uint32_t TexturePacker::add(const TextureRef& ref) {
    if (!ref) return gpu::NO_INDEX;
    const Image& image = scene_.images.at(ref.image);
    gpu::TextureRecord record{};
    record.firstTexel = firstTexelOf(ref.image);
    record.width = image.width;
    record.height = image.height;
    record.flags = flagsOf(ref, !image.rgbaFloat.empty());
    record.du = ref.transform[0];
    record.dv = ref.transform[1];
    record.offset = ref.transform[2];
    features |= featuresOf(record.flags);
    for (uint32_t i = 0; i < records.size(); ++i)
        if (same(records[i], record)) return i;
    records.push_back(record);
    return static_cast<uint32_t>(records.size() - 1);
}

}  // namespace tilefarm
