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

glm::dvec4 nearestTexel(const Image& image, const TextureRef& ref, const glm::vec2& uv) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return glm::dvec4(0);
    const auto at = static_cast<size_t>(
        (wrapped(uv.y, image.height, ref.wrapT) * image.width + wrapped(uv.x, image.width, ref.wrapS)) * 4);
    if (!image.rgbaFloat.empty())
        return {image.rgbaFloat[at], image.rgbaFloat[at + 1], image.rgbaFloat[at + 2],
                image.rgbaFloat[at + 3]};
    return {decoded(image.rgba8[at], ref.srgb), decoded(image.rgba8[at + 1], ref.srgb),
            decoded(image.rgba8[at + 2], ref.srgb), decoded(image.rgba8[at + 3], false)};
}

// A point of a triangle by its weights.
struct TrianglePoint {
    const Scene& scene;
    const WorldGeometry& world;
    glm::uvec3 corners;
    float u, v;

    template <typename T>
    T interpolated(const std::vector<T>& values, const T& missing) const {
        if (values.empty()) return missing;
        return values[corners.x] * (1 - u - v) + values[corners.y] * u + values[corners.z] * v;
    }
    glm::dvec4 texel(const TextureRef& ref) const {
        if (!ref) return glm::dvec4(1);
        const glm::vec2 uv = interpolated(ref.uvSet == 1 ? world.uv1 : world.uv0, glm::vec2(0));
        return nearestTexel(scene.images[ref.image], ref, ref.transform * glm::vec3(uv, 1));
    }
};

double coverageAt(const TrianglePoint& point, const Material& m) {
    if (m.alphaMode == AlphaMode::opaque) return 1;
    const double color = point.interpolated(point.world.colors, glm::vec4(1)).a;
    return coverageOf(m, m.alpha * color * point.texel(m.baseColorTexture).a);
}

}  // namespace

double coverageOf(const Material& material, double alpha) {
    switch (material.alphaMode) {
        case AlphaMode::opaque: return 1;
        case AlphaMode::mask: return alpha >= material.alphaCutoff ? 1 : 0;
        case AlphaMode::blend: return std::clamp(alpha, 0.0, 1.0);
    }
    return 1;
}

glm::dvec3 averageEmission(const Scene& scene, const Material& material, const WorldGeometry& world,
                           uint32_t triangle) {
    if (!material.emissionTexture && material.alphaMode == AlphaMode::opaque) return glm::dvec3(1);
    glm::dvec3 sum(0);
    int points = 0;
    for (int i = 0; i < kStrata; ++i)
        for (int j = 0; i + j < kStrata; ++j, ++points) {
            const TrianglePoint point{scene, world, world.triangles[triangle],
                                      (static_cast<float>(i) + 1.f / 3) / kStrata,
                                      (static_cast<float>(j) + 1.f / 3) / kStrata};
            sum += glm::dvec3(point.texel(material.emissionTexture)) * coverageAt(point, material);
        }
    return sum / double(points);
}

}  // namespace tilefarm
