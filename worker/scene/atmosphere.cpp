#include "worker/scene/atmosphere.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr double kGround = 6360, kTop = 6460;  // radii, km
const glm::dvec3 kRayleigh(5.802e-3, 13.558e-3, 33.1e-3);
const glm::dvec3 kOzone(0.650e-3, 1.881e-3, 0.085e-3);
const glm::dvec3 kAngstrom(std::pow(680. / 550, -1.3), 1, std::pow(440. / 550, -1.3));
constexpr double kRayleighHeight = 8, kAerosolHeight = 1.2, kAerosolAlbedo = 0.9, kAerosolG = 0.8;

// Tables: transmittance by zenith distance and altitude, in the mapping of Bruneton, Neyret 2008, section 4; multiple
// scattering by the sun's cosine and altitude.
constexpr int kMuSize = 256, kRadiusSize = 64, kSunSize = 32, kAltitudeSize = 16;
constexpr int kTransmittanceSteps = 48, kViewSteps = 48, kMultipleSteps = 20, kMultipleDirections = 8;

// Distance along a ray from radius r to the sphere of radius R around it, or to the far side of one within.
double distanceOut(double r, double mu, double R) {
    return std::max(0.0, -r * mu + std::sqrt(std::max(0.0, r * r * (mu * mu - 1) + R * R)));
}

bool meetsGround(double r, double mu) {
    return mu < 0 && r * r * (mu * mu - 1) + kGround * kGround >= 0;
}

double rayleighPhase(double c) {
    return 3 / (16 * pi) * (1 + c * c);
}

double cornetteShanks(double c, double g) {
    return 3 / (8 * pi) * (1 - g * g) * (1 + c * c) / ((2 + g * g) * std::pow(1 + g * g - 2 * g * c, 1.5));
}

// Value of a table at fractional coordinates in [0, 1].
glm::dvec3 lookup(const std::vector<glm::dvec3>& table, int width, int height, double x, double y) {
    x = std::clamp(x, 0.0, 1.0) * (width - 1);
    y = std::clamp(y, 0.0, 1.0) * (height - 1);
    const int i = std::min(static_cast<int>(x), width - 2), j = std::min(static_cast<int>(y), height - 2);
    const auto at = [&](int a, int b) { return table[static_cast<size_t>(b * width + a)]; };
    return glm::mix(glm::mix(at(i, j), at(i + 1, j), x - i), glm::mix(at(i, j + 1), at(i + 1, j + 1), x - i), y - j);
}

// Points along a ray, denser near its start where the air is, each with the stretch it stands for.
template <typename Visit>
void march(double r, double mu, double length, int steps, Visit visit) {
    double before = 0;
    for (int i = 0; i < steps; ++i) {
        const double f = double(i + 1) / steps, end = length * f * f, t = 0.5 * (before + end);
        const double radius = std::sqrt(r * r + t * t + 2 * r * t * mu);
        visit(t, radius, end - before);
        before = end;
    }
}

}  // namespace

Atmosphere::Atmosphere(double turbidity, double groundAlbedo) {
    const double opticalDepth = std::max(turbidity - 1, 0.0) * kRayleigh.g * kRayleighHeight;
    aerosolExtinction_ = kAngstrom * (opticalDepth / kAerosolHeight);
    aerosolScattering_ = aerosolExtinction_ * kAerosolAlbedo;
    tabulateTransmittance();
    tabulateMultipleScattering(groundAlbedo);
}

Atmosphere::Medium Atmosphere::mediumAt(double altitude) const {
    const double h = std::max(altitude, 0.0), aerosol = std::exp(-h / kAerosolHeight);
    Medium m;
    m.rayleigh = kRayleigh * std::exp(-h / kRayleighHeight);
    m.aerosol = aerosolScattering_ * aerosol;
    m.extinction = m.rayleigh + aerosolExtinction_ * aerosol + kOzone * std::max(0.0, 1 - std::abs(h - 25) / 15);
    return m;
}

glm::dvec3 Atmosphere::opticalTransmittance(double radius, double cosZenith) const {
    glm::dvec3 depth(0);
    march(radius, cosZenith, distanceOut(radius, cosZenith, kTop), kTransmittanceSteps,
          [&](double, double r, double dt) { depth += mediumAt(r - kGround).extinction * dt; });
    return glm::exp(-depth);
}

void Atmosphere::tabulateTransmittance() {
    const double horizon = std::sqrt(kTop * kTop - kGround * kGround);
    for (int j = 0; j < kRadiusSize; ++j)
        for (int i = 0; i < kMuSize; ++i) {
            const double rho = horizon * j / (kRadiusSize - 1);
            const double r = std::sqrt(rho * rho + kGround * kGround);
            const double least = kTop - r, most = rho + horizon;
            const double d = least + (most - least) * i / (kMuSize - 1);
            const double mu = d == 0 ? 1 : (horizon * horizon - rho * rho - d * d) / (2 * r * d);
            transmittance_.push_back(opticalTransmittance(r, std::clamp(mu, -1.0, 1.0)));
        }
}

glm::dvec3 Atmosphere::transmittance(double altitude, double cosZenith) const {
    const double r = kGround + std::clamp(altitude, 0.0, kTop - kGround);
    if (meetsGround(r, cosZenith)) return glm::dvec3(0);
    const double horizon = std::sqrt(kTop * kTop - kGround * kGround);
    const double rho = std::sqrt(std::max(0.0, r * r - kGround * kGround));
    const double least = kTop - r, most = rho + horizon, d = distanceOut(r, cosZenith, kTop);
    return lookup(transmittance_, kMuSize, kRadiusSize, most > least ? (d - least) / (most - least) : 0,
                  rho / horizon);
}

void Atmosphere::tabulateMultipleScattering(double groundAlbedo) {
    for (int j = 0; j < kAltitudeSize; ++j)
        for (int i = 0; i < kSunSize; ++i)
            multiple_.push_back(multipleScatteringOf((kTop - kGround) * j * j / ((kAltitudeSize - 1.) * (kAltitudeSize - 1)),
                                                     -1 + 2.0 * i / (kSunSize - 1), groundAlbedo));
}

// Light of all orders from the second on that a point gets on average from everywhere (Hillaire 2020, eq. 5 to 10).
glm::dvec3 Atmosphere::multipleScatteringOf(double altitude, double cosSun, double groundAlbedo) const {
    const double r = kGround + altitude;
    const glm::dvec3 toSun(std::sqrt(std::max(0.0, 1 - cosSun * cosSun)), cosSun, 0);
    glm::dvec3 second(0), transferred(0);
    for (int i = 0; i < kMultipleDirections; ++i)
        for (int j = 0; j < kMultipleDirections; ++j) {
            const double mu = -1 + 2 * (i + 0.5) / kMultipleDirections, phi = 2 * pi * (j + 0.5) / kMultipleDirections;
            const glm::dvec3 d(std::sqrt(1 - mu * mu) * std::cos(phi), mu, std::sqrt(1 - mu * mu) * std::sin(phi));
            const bool ground = meetsGround(r, mu);
            const double length =
                ground ? -r * mu - std::sqrt(std::max(0.0, r * r * (mu * mu - 1) + kGround * kGround)) : distanceOut(r, mu, kTop);
            glm::dvec3 through(1);
            const auto sunAt = [&](double t, double radius) {
                return (r * cosSun + t * glm::dot(d, toSun)) / radius;  // its cosine at the point
            };
            march(r, mu, length, kMultipleSteps, [&](double t, double radius, double dt) {
                const Medium m = mediumAt(radius - kGround);
                const glm::dvec3 left = glm::exp(-m.extinction * dt), share = (1.0 - left) / m.extinction;
                const glm::dvec3 sun = transmittance(radius - kGround, sunAt(t, radius));
                second += through * share * m.scattering() * sun / (4 * pi);
                transferred += through * share * m.scattering();
                through *= left;
            });
            if (ground) {
                const double cosine = std::max(0.0, sunAt(length, kGround));
                second += through * transmittance(0, cosine) * (cosine * groundAlbedo / pi);
            }
        }
    constexpr double kDirections = kMultipleDirections * kMultipleDirections;
    return second / kDirections / (1.0 - transferred / kDirections);
}

glm::dvec3 Atmosphere::multipleScattering(double altitude, double cosSun) const {
    return lookup(multiple_, kSunSize, kAltitudeSize, (cosSun + 1) / 2,
                  std::sqrt(std::max(0.0, altitude) / (kTop - kGround)));
}

glm::dvec3 Atmosphere::radiance(double altitude, const glm::dvec3& direction, const glm::dvec3& toSun) const {
    const double r = kGround + altitude, mu = direction.y, cosine = glm::dot(direction, toSun);
    const double rayleigh = rayleighPhase(cosine), aerosol = cornetteShanks(cosine, kAerosolG);
    glm::dvec3 sum(0), through(1);
    march(r, mu, distanceOut(r, mu, kTop), kViewSteps, [&](double t, double radius, double dt) {
        const Medium m = mediumAt(radius - kGround);
        const double cosSun = (r * toSun.y + t * cosine) / radius;
        const glm::dvec3 sun = transmittance(radius - kGround, cosSun);
        const glm::dvec3 scattered = sun * (m.rayleigh * rayleigh + m.aerosol * aerosol) +
                                     m.scattering() * multipleScattering(radius - kGround, cosSun);
        // Exact for a stretch of even medium (Hillaire 2020, section 5.5 and its source, Hillaire 2015).
        const glm::dvec3 left = glm::exp(-m.extinction * dt);
        sum += through * scattered * (1.0 - left) / m.extinction;
        through *= left;
    });
    return sum;
}

}  // namespace tilefarm
