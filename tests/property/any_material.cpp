#include "tests/property/any_material.h"

#include <rapidcheck.h>

#include <array>
#include <cmath>
#include <numbers>
#include <ostream>

#include "shaders/gpu_types.h"

namespace tilefarm {
namespace {

constexpr int kCodes = 64, kSteps = 1024;  // codes of a material; values of one

struct Kind {
    float ior;
    uint32_t flags;
};
constexpr Kind kFew[]{{1.5f, 0},
                      {1, 0},
                      {1.1f, 0},
                      {0, 0},
                      {2.4f, 0},
                      {1.5f, gpu::MATERIAL_BECKMANN},
                      {1.5f, gpu::MATERIAL_PHONG},
                      {1.8f, gpu::MATERIAL_SCHLICK}};
constexpr float kIors[]{1.5f, 1, 1.0001f, 1.1f, 1.33f, 1.8f, 2.4f, 0, 1000};

/// Reads numbers out of codes one after the other. Code 0, to which RapidCheck shrinks, is the neutral value.
class Reader {
public:
    explicit Reader(const std::vector<int>& codes) : codes_(codes) {}

    bool maybe(int oneIn) { return next() > kSteps - kSteps / oneIn; }
    size_t below(size_t n) { return static_cast<size_t>(next()) * n / kSteps; }
    /// Neutral 3 of 8 times, an end 2 of 8, else between.
    float number(float neutral, float least = 0, float most = 1) {
        const int code = next();
        if (code < 3 * kSteps / 8) return neutral;
        if (code < 4 * kSteps / 8) return least;
        if (code < 5 * kSteps / 8) return most;
        return least +
               (most - least) * static_cast<float>(code - 5 * kSteps / 8 + 1) / (3.f * kSteps / 8 + 1);
    }
    glm::vec3 color(float neutral, float most = 1) {
        const float r = number(neutral, 0, most);
        if (!maybe(2)) return glm::vec3(r);
        const float g = number(neutral, 0, most), b = number(neutral, 0, most);
        return {r, g, b};
    }
    /// A roughness α: on either side of ALPHA_DELTA, at the ends, or anything in [1e-4, 1] by its logarithm.
    float alpha() {
        static constexpr float special[]{0.25f, 1, 1e-3f, 9.99e-4f, 1e-6f, 0};
        const int code = next();
        if (code < kSteps / 2) return special[static_cast<size_t>(code) * std::size(special) / (kSteps / 2)];
        return std::pow(10.f, -4 + 4 * static_cast<float>(code - kSteps / 2) / (kSteps / 2));
    }
    glm::vec3 direction() {
        static constexpr double special[]{1, 0.5, 0.1, 1e-3, 1e-5, 1e-7};
        const int code = next();
        const double within = static_cast<double>(code - kSteps / 2 + 1) / (kSteps / 2 + 1);
        const double z = code < kSteps / 2
                             ? special[static_cast<size_t>(code) * std::size(special) / (kSteps / 2)]
                             : within;
        const double phi = 2 * std::numbers::pi * next() / kSteps, r = std::sqrt((1 - z) * (1 + z));
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

private:
    int next() { return codes_[at_++]; }
    const std::vector<int>& codes_;
    size_t at_ = 0;
};

void readInterface(Reader& read, Variety variety, ProbeMaterial& m) {
    uint32_t flags = 0;
    if (variety == Variety::few) {
        const Kind& kind = kFew[read.below(std::size(kFew))];
        m.ior = kind.ior;
        flags = kind.flags;
    } else {
        m.ior = kIors[read.below(std::size(kIors))];
        flags = std::array{0u, gpu::MATERIAL_BECKMANN, gpu::MATERIAL_PHONG}[read.below(6) % 3];
        if (flags == 0 && read.maybe(3)) flags |= gpu::MATERIAL_SCHLICK;
    }
    m.alpha = read.alpha();
    const float along = read.number(0);
    if (along > 0) m.alphaT = m.alpha + (1 - m.alpha) * along * along;  // KHR_materials_anisotropy
    m.transmission = read.number(0);
    if (read.maybe(3)) flags |= gpu::MATERIAL_THIN;
    m.specular = read.number(1);
    m.specularColor = read.color(1, read.maybe(4) ? 30.f : 1.f);
    m.iridescence = read.number(0);
    m.iridescenceIor = read.number(1.3f, 1, 3);
    m.iridescenceThickness = read.number(400, 0, 1200);
    if (m.iridescence == 0) m.iridescenceThickness = 0;
    if (read.maybe(4)) {
        flags |= gpu::MATERIAL_CONDUCTOR;
        for (int c = 0; c < 3; ++c) {
            m.conductorEta[c] = read.number(1, 0, 4);
            m.conductorK[c] = read.number(0, 0, 8);
        }
    }
    m.flags = static_cast<float>(flags);
}

void readLayers(Reader& read, ProbeMaterial& m) {
    m.clearcoat = read.number(0);
    m.clearcoatAlpha = read.alpha();
    const float tilt = read.number(0, 0, 0.6f);
    m.clearcoatNormal = {std::sin(tilt), 0, std::cos(tilt)};
    m.sheenColor = read.color(0);
    m.sheenRoughness = read.number(0.5f);
    m.disneySheen = read.number(0);
    m.disneySheenTint = read.number(0);
}

/// What the loader and the shaders leave out together: dispersion but in solids, layers on the inside.
void settle(ProbeMaterial& m) {
    const bool thin = (static_cast<uint32_t>(m.flags) & gpu::MATERIAL_THIN) != 0;
    if (thin || m.transmission == 0) m.dispersion = 0;
    if (m.frontFace == 0 && !thin && (m.transmission > 0 || m.diffuseTransmission > 0))
        m.clearcoat = m.disneySheen = 0, m.sheenColor = glm::vec3(0);
    if (m.clearcoat == 0) m.clearcoatAlpha = 0, m.clearcoatNormal = {0, 0, 1};
}

SeenMaterial decoded(const std::vector<int>& codes, Variety variety) {
    Reader read(codes);
    SeenMaterial seen;
    ProbeMaterial& m = seen.material;
    m.baseColor = read.color(1);
    m.metallic = read.number(0);
    m.frontFace = read.maybe(3) ? 0.f : 1.f;
    readInterface(read, variety, m);
    readLayers(read, m);
    m.diffuseTransmission = read.number(0);
    m.diffuseTransmissionColor = read.color(1);
    // Each takes tables of its own.
    static constexpr float dispersions[]{0, 0, 0, 0, 0.3f, 1, 8, 1000};
    m.dispersion = dispersions[read.below(std::size(dispersions))];
    if (static_cast<uint32_t>(m.flags) & ~gpu::MATERIAL_THIN) m.dispersion = 0;
    if (m.ior != 1.5f && (variety == Variety::few || m.ior != 2.4f)) m.dispersion = 0;
    if (variety == Variety::few && m.dispersion > 0) m.dispersion = 1;
    uint32_t flags = static_cast<uint32_t>(m.flags);
    if (read.maybe(4)) flags |= gpu::MATERIAL_DISNEY_DIFFUSE;
    if (read.maybe(3)) flags |= gpu::MATERIAL_GTR1;
    m.flags = static_cast<float>(flags);
    m.subsurface = read.number(0);
    m.orenNayarSigma = read.number(0, 0, 1.57f);
    settle(m);
    seen.wo = read.direction();
    return seen;
}

}  // namespace

rc::Gen<SeenMaterial> anyMaterial(Variety variety) {
    const auto code = rc::gen::inRange(0, kSteps);
    return rc::gen::resize(rc::kNominalSize, rc::gen::map(rc::gen::container<std::vector<int>>(kCodes, code),
                                                          [variety](const std::vector<int>& codes) {
                                                              return decoded(codes, variety);
                                                          }));
}

SeenMaterial materialNumber(uint64_t i, Variety variety) {
    return anyMaterial(variety)(rc::Random(i), rc::kNominalSize).value();
}

uint64_t everyLobe() {
    uint64_t features = 0;
    for (const uint32_t feature :
         {gpu::FEATURE_SPECULAR, gpu::FEATURE_MIRROR, gpu::FEATURE_TRANSMISSION, gpu::FEATURE_SPECULAR_COLOR,
          gpu::FEATURE_CLEARCOAT, gpu::FEATURE_SHEEN, gpu::FEATURE_ANISOTROPY, gpu::FEATURE_IRIDESCENCE,
          gpu::FEATURE_DISPERSION, gpu::FEATURE_DIFFUSE_TRANSMISSION, gpu::FEATURE_CONDUCTOR,
          gpu::FEATURE_OREN_NAYAR, gpu::FEATURE_DISNEY_DIFFUSE, gpu::FEATURE_DISNEY_SHEEN, gpu::FEATURE_GTR1,
          gpu::FEATURE_BECKMANN, gpu::FEATURE_PHONG, gpu::FEATURE_SCHLICK})
        features |= gpu::bit(feature);
    return features;
}

double etaOf(const ProbeMaterial& m) {
    const bool thin = (static_cast<uint32_t>(m.flags) & gpu::MATERIAL_THIN) != 0;
    if (thin || m.transmission == 0) return 1;
    const double ior = m.ior == 0 ? 1.5 : double{m.ior};
    return m.frontFace != 0 ? ior : 1 / ior;
}

std::ostream& operator<<(std::ostream& out, const SeenMaterial& seen) {
    const ProbeMaterial& m = seen.material;
    const ProbeMaterial plain;
    out.precision(9);
    out << "{";
    const auto number = [&](const char* name, float value, float neutral) {
        if (value != neutral) out << "." << name << " = " << value << ", ";
    };
    const auto vector = [&](const char* name, const glm::vec3& v, const glm::vec3& neutral) {
        if (v != neutral) out << "." << name << " = {" << v.x << ", " << v.y << ", " << v.z << "}, ";
    };
    vector("baseColor", m.baseColor, plain.baseColor);
    number("metallic", m.metallic, plain.metallic);
    number("alpha", m.alpha, plain.alpha);
    number("alphaT", m.alphaT, plain.alphaT);
    number("ior", m.ior, plain.ior);
    number("transmission", m.transmission, plain.transmission);
    number("flags", m.flags, plain.flags);
    number("specular", m.specular, plain.specular);
    number("frontFace", m.frontFace, plain.frontFace);
    vector("specularColor", m.specularColor, plain.specularColor);
    number("dispersion", m.dispersion, plain.dispersion);
    vector("conductorEta", m.conductorEta, plain.conductorEta);
    number("iridescence", m.iridescence, plain.iridescence);
    vector("conductorK", m.conductorK, plain.conductorK);
    number("iridescenceIor", m.iridescenceIor, plain.iridescenceIor);
    number("iridescenceThickness", m.iridescenceThickness, plain.iridescenceThickness);
    number("clearcoat", m.clearcoat, plain.clearcoat);
    number("clearcoatAlpha", m.clearcoatAlpha, plain.clearcoatAlpha);
    number("sheenRoughness", m.sheenRoughness, plain.sheenRoughness);
    vector("clearcoatNormal", m.clearcoatNormal, plain.clearcoatNormal);
    number("disneySheen", m.disneySheen, plain.disneySheen);
    vector("sheenColor", m.sheenColor, plain.sheenColor);
    number("disneySheenTint", m.disneySheenTint, plain.disneySheenTint);
    vector("diffuseTransmissionColor", m.diffuseTransmissionColor, plain.diffuseTransmissionColor);
    number("diffuseTransmission", m.diffuseTransmission, plain.diffuseTransmission);
    number("subsurface", m.subsurface, plain.subsurface);
    number("orenNayarSigma", m.orenNayarSigma, plain.orenNayarSigma);
    return out << "}, wo {" << seen.wo.x << ", " << seen.wo.y << ", " << seen.wo.z << "}";
}

}  // namespace tilefarm
