#include "worker/render/texture_average.h"

#include <algorithm>
#include <cmath>

#include "worker/scene/srgb.h"

namespace tilefarm {
namespace {

constexpr int kStrata = 8;  // per edge: 36 points

double decoded(uint8_t value, bool srgb) {
    const double x = value / 255.0;
    return srgb ? srgbToLinear(x) : x;
}

int64_t wrapped(double coordinate, uint32_t size, Wrap wrap) {
    const double n = size;
    if (wrap == Wrap::clamp) coordinate = std::clamp(coordinate, 0.0, 1.0);
    if (wrap == Wrap::repeat) coordinate -= std::floor(coordinate);
    if (wrap == Wrap::mirror) {
        coordinate -= 2 * std::floor(coordinate / 2);
        if (coordinate > 1) coordinate = 2 - coordinate;
    }
    return std::clamp(static_cast<int64_t>(coordinate * n), int64_t{0}, static_cast<int64_t>(size) - 1);
}

glm::dvec3 nearestTexel(const Image& image, const TextureRef& ref, const glm::vec2& uv) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return glm::dvec3(0);
    const auto at = static_cast<size_t>(
        (wrapped(uv.y, image.height, ref.wrapT) * image.width + wrapped(uv.x, image.width, ref.wrapS)) * 4);
    if (!image.rgbaFloat.empty())
        return {image.rgbaFloat[at], image.rgbaFloat[at + 1], image.rgbaFloat[at + 2]};
    return {decoded(image.rgba8[at], ref.srgb), decoded(image.rgba8[at + 1], ref.srgb),
            decoded(image.rgba8[at + 2], ref.srgb)};
}

}  // namespace

glm::dvec3 averageOverTriangle(const Scene& scene, const TextureRef& ref, const WorldGeometry& world,
                               uint32_t triangle) {
    if (!ref) return glm::dvec3(1);
    const auto& uvs = ref.uvSet == 1 ? world.uv1 : world.uv0;
    const glm::uvec3 corners = world.triangles[triangle];
    glm::dvec3 sum(0);
    int points = 0;
    for (int i = 0; i < kStrata; ++i)
        for (int j = 0; i + j < kStrata; ++j, ++points) {
            const float u = (static_cast<float>(i) + 1.f / 3) / kStrata,
                        v = (static_cast<float>(j) + 1.f / 3) / kStrata;
            glm::vec2 uv(0);
            if (!uvs.empty()) uv = uvs[corners.x] * (1 - u - v) + uvs[corners.y] * u + uvs[corners.z] * v;
            sum += nearestTexel(scene.images[ref.image], ref, ref.transform * glm::vec3(uv, 1));
        }
    return sum / double(points);
}

}  // namespace tilefarm
