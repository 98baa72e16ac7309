#include "worker/scene/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/scene/atmosphere.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr int kWidth = 512, kHeight = 256;
constexpr int kAzimuths = 129;  // from the sun's azimuth to the opposite one: the sky is the same on both sides

double radians(double degrees) {
    return degrees * pi / 180;
}

/// Radiance by row of the image's upper half and azimuth from the sun's.
class HalfSky {
public:
    HalfSky(const Atmosphere& air, double altitude, double elevation) {
        const glm::dvec3 toSun(std::cos(elevation), std::sin(elevation), 0);
        for (int y = 0; y < kHeight / 2; ++y)
            for (int a = 0; a < kAzimuths; ++a) {
                const double theta = pi * (y + 0.5) / kHeight, phi = pi * a / (kAzimuths - 1);
                values_.push_back(air.radiance(
                    altitude,
                    {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)}, toSun));
            }
    }

    /// `azimuth` in [0, π].
    glm::dvec3 at(int y, double azimuth) const {
        const double a = azimuth / pi * (kAzimuths - 1);
        const int i = std::clamp(static_cast<int>(a), 0, kAzimuths - 2);
        const glm::dvec3* row = &values_[static_cast<size_t>(y) * kAzimuths];
        return glm::mix(row[i], row[i + 1], a - i);
    }

    /// On a horizontal plane.
    glm::dvec3 irradiance() const {
        glm::dvec3 sum(0);
        for (int y = 0; y < kHeight / 2; ++y) {
            const double theta = pi * (y + 0.5) / kHeight;
            for (int a = 0; a + 1 < kAzimuths; ++a)
                sum += at(y, pi * (a + 0.5) / (kAzimuths - 1)) * (std::cos(theta) * std::sin(theta));
        }
        return sum * (pi / kHeight) * (2 * pi / (kAzimuths - 1));
    }

private:
    std::vector<glm::dvec3> values_;
};

Image paint(const HalfSky& sky, const glm::dvec3& ground, const glm::dvec3& toSun, double scale) {
    Image image;
    image.name = "sun and sky";
    image.width = kWidth;
    image.height = kHeight;
    image.rgbaFloat.reserve(size_t{4} * kWidth * kHeight);
    const double sunAzimuth = std::atan2(toSun.z, toSun.x);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double azimuth = ((x + 0.5) / kWidth - 0.5) * 2 * pi;
            const double apart = std::abs(std::remainder(azimuth - sunAzimuth, 2 * pi));
            const glm::vec3 color((y < kHeight / 2 ? sky.at(y, apart) : ground) * scale);
            image.rgbaFloat.insert(image.rgbaFloat.end(), {color.r, color.g, color.b, 1.f});
        }
    return image;
}

glm::dvec3 rotated(const glm::dvec3& d, double angle) {
    return {d.x * std::cos(angle) + d.z * std::sin(angle), d.y, -d.x * std::sin(angle) + d.z * std::cos(angle)};
}

}  // namespace

glm::dvec3 sunDirection(const SkySettings& settings) {
    const double elevation = radians(settings.sunElevation), azimuth = radians(settings.sunAzimuth);
    return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), -std::cos(elevation) * std::cos(azimuth)};
}

void addSky(Scene& scene, const SkySettings& settings, double intensity, double rotation) {
    const Atmosphere air(settings.turbidity, settings.groundAlbedo);
    // A metre above the ground at least: on it, the horizon itself is a division by zero.
    const double altitude = std::max(settings.altitude, 1.0) / 1000, elevation = radians(settings.sunElevation);
    const glm::dvec3 toSun = sunDirection(settings);
    const double scale = kSolarIrradiance * intensity;
    const HalfSky sky(air, altitude, elevation);
    const glm::dvec3 through = toSun.y > 0 ? air.transmittance(altitude, toSun.y) : glm::dvec3(0);
    const glm::dvec3 ground =
        (sky.irradiance() + through * std::max(toSun.y, 0.0) * settings.sunIntensity) * (settings.groundAlbedo / pi);

    scene.environment.name = "sun and sky";
    scene.environment.image = paint(sky, ground, toSun, scale);
    scene.environment.rotation = rotation;
    const glm::vec3 color(through * scale * settings.sunIntensity);
    if (color == glm::vec3(0)) return;
    PunctualLight sun;
    sun.type = PunctualType::directional;
    sun.name = "sun";
    sun.color = color;
    sun.direction = -glm::normalize(glm::vec3(rotated(toSun, rotation)));
    sun.angularRadius = static_cast<float>(radians(settings.sunAngularDiameter) / 2);
    scene.lights.push_back(sun);
}

}  // namespace tilefarm
