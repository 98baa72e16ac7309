#include "worker/scene/cube_map.h"

#include <OpenEXR/ImfEnvmap.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

// A texel of the cube's middle becomes about one and a half of the sphere; small cubes keep sharp edges.
constexpr uint32_t kTexelsPerFace = 4, kLeastWidth = 512, kMostWidth = 16384;
constexpr int kSubsamples = 2;  // a side

class Cube {
public:
    explicit Cube(const Image& image)
        : image_(image),
          window_(Imath::V2i(0, 0),
                  Imath::V2i(static_cast<int>(image.width) - 1, static_cast<int>(image.height) - 1)) {}

    glm::vec3 along(const Imath::V3f& direction) const {
        Imf::CubeMapFace face;
        Imath::V2f inFace;
        Imf::CubeMap::faceAndPixelPosition(direction, window_, face, inFace);
        const Imath::V2f at = Imf::CubeMap::pixelPosition(face, window_, inFace);
        return bilinear(at, Imf::CubeMap::dataWindowForFace(face, window_));
    }

private:
    glm::vec3 texel(int x, int y) const {
        const float* t =
            &image_.rgbaFloat[4 * (static_cast<size_t>(y) * image_.width + static_cast<size_t>(x))];
        return {t[0], t[1], t[2]};
    }
    glm::vec3 bilinear(const Imath::V2f& at, const Imath::Box2i& face) const {
        const int x0 = std::clamp(static_cast<int>(std::floor(at.x)), face.min.x, face.max.x),
                  y0 = std::clamp(static_cast<int>(std::floor(at.y)), face.min.y, face.max.y),
                  x1 = std::min(x0 + 1, face.max.x), y1 = std::min(y0 + 1, face.max.y);
        const float fx = at.x - static_cast<float>(x0), fy = at.y - static_cast<float>(y0);
        // Not by glm::mix, in which 0 times infinity would spoil texels beside an infinite one.
        const auto mixed = [](const glm::vec3& a, const glm::vec3& b, float f) {
            return f <= 0 ? a : f >= 1 ? b : a * (1 - f) + b * f;
        };
        return mixed(mixed(texel(x0, y0), texel(x1, y0), fx), mixed(texel(x0, y1), texel(x1, y1), fx), fy);
    }

    const Image& image_;
    Imath::Box2i window_;
};

// u and v as in shaders/lights/environment.glsl.
Imath::V3f directionOf(double u, double v) {
    const double phi = (u - 0.5) * glm::two_pi<double>(), theta = v * glm::pi<double>();
    return {static_cast<float>(std::sin(theta) * std::cos(phi)), static_cast<float>(std::cos(theta)),
            static_cast<float>(std::sin(theta) * std::sin(phi))};
}

glm::vec3 averageOver(const Cube& cube, uint32_t x, uint32_t y, uint32_t width, uint32_t height) {
    glm::vec3 sum(0);
    for (int j = 0; j < kSubsamples; ++j)
        for (int i = 0; i < kSubsamples; ++i)
            sum += cube.along(
                directionOf((x + (i + 0.5) / kSubsamples) / width, (y + (j + 0.5) / kSubsamples) / height));
    return sum / static_cast<float>(kSubsamples * kSubsamples);
}

}  // namespace

Image equirectangularOf(const Image& image) {
    if (uint64_t{image.width} * 6 != image.height)
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("its cube map has {} x {} texels; six faces below each other are N x 6 N",
                                image.width, image.height));
    const Cube cube(image);
    Image sphere;
    sphere.name = image.name;
    sphere.width = std::clamp(image.width * kTexelsPerFace, kLeastWidth, kMostWidth);
    sphere.height = sphere.width / 2;
    sphere.rgbaFloat.reserve(size_t{4} * sphere.width * sphere.height);
    for (uint32_t y = 0; y < sphere.height; ++y)
        for (uint32_t x = 0; x < sphere.width; ++x) {
            const glm::vec3 color = averageOver(cube, x, y, sphere.width, sphere.height);
            sphere.rgbaFloat.insert(sphere.rgbaFloat.end(), {color.r, color.g, color.b, 1.0f});
        }
    return sphere;
}

}  // namespace tilefarm
