#include "worker/render/vertex_packer.h"

#include "shaders/gpu_types.h"

namespace tilefarm {
namespace {

template <typename T>
T at(const std::vector<T>& values, size_t i, const T& missing) {
    return values.empty() ? missing : values[i];
}

}  // namespace

uint32_t vertexTexelsFor(uint64_t features) {
    if ((features & gpu::bit(gpu::FEATURE_VERTEX_COLORS)) != 0) return 4;
    if ((features & (gpu::bit(gpu::FEATURE_NORMAL_MAPS) | gpu::bit(gpu::FEATURE_ANISOTROPY))) != 0) return 3;
    if ((features & (gpu::bit(gpu::FEATURE_TEXTURES) | gpu::bit(gpu::FEATURE_UV_CHANNEL))) != 0) return 2;
    return 1;
}

std::vector<glm::vec4> packVertices(const WorldGeometry& world, uint32_t texels) {
    std::vector<glm::vec4> packed;
    packed.reserve(world.positions.size() * texels);
    for (size_t i = 0; i < world.positions.size(); ++i) {
        const glm::vec3 normal = at(world.normals, i, glm::vec3(0));
        const glm::vec2 uv0 = at(world.uv0, i, glm::vec2(0)), uv1 = at(world.uv1, i, glm::vec2(0));
        packed.emplace_back(normal, uv0.x);
        if (texels > 1) packed.emplace_back(uv0.y, uv1.x, uv1.y, 0.f);
        if (texels > 2) packed.push_back(at(world.tangents, i, glm::vec4(0)));
        if (texels > 3) packed.push_back(at(world.colors, i, glm::vec4(1)));
    }
    return packed;
}

std::vector<glm::uvec4> packPrimitives(const WorldGeometry& world) {
    std::vector<glm::uvec4> packed;
    packed.reserve(world.primitiveCount());
    for (uint32_t i = 0; i < world.triangleCount(); ++i)
        packed.emplace_back(world.triangles[i], world.instanceOf(i).material);
    for (uint32_t i = 0; i < world.shapes.size(); ++i)
        packed.emplace_back(gpu::NO_INDEX, gpu::NO_INDEX, i, world.shapes[i].shape.material);
    return packed;
}

}  // namespace tilefarm
