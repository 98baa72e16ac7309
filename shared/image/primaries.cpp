#include "shared/image/primaries.h"

#include <OpenEXR/ImfChromaticities.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

// Files give three or four digits.
constexpr double kRounding = 5e-4;
constexpr double kLeastDeterminant = 1e-6;

// Cone responses of Bradford's transform (Lam 1985), as ICC profiles have it.
constexpr ColorMatrix kBradford{
    {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};

bool near(const Primaries::Xy& a, const Primaries::Xy& b) {
    return std::abs(a[0] - b[0]) < kRounding && std::abs(a[1] - b[1]) < kRounding;
}

// Imath multiplies rows from the left, so its matrices are transposed.
Imath::M33d transposed(const ColorMatrix& m) {
    Imath::M33d t;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) t[c][r] = m[size_t(r)][size_t(c)];
    return t;
}

Imath::V2f v2f(const Primaries::Xy& xy) {
    return {static_cast<float>(xy[0]), static_cast<float>(xy[1])};
}

[[noreturn]] void failPrimaries(const Primaries& p) {
    throw Error(ErrorCode::invalidArgument,
                fmt::format("its primaries ({}, {}), ({}, {}), ({}, {}) with white ({}, {}) make no colours",
                            p.red[0], p.red[1], p.green[0], p.green[1], p.blue[0], p.blue[1], p.white[0],
                            p.white[1]));
}

Imath::M33d toXyz(const Primaries& p) {
    const Imf::Chromaticities chromaticities(v2f(p.red), v2f(p.green), v2f(p.blue), v2f(p.white));
    Imath::M33d xyz;
    try {
        const Imath::M44f m = Imf::RGBtoXYZ(chromaticities, 1);
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) xyz[r][c] = double{m[r][c]};
    } catch (const std::exception&) {  // below, like others
        xyz = Imath::M33d(0.0);
    }
    const double determinant = xyz.determinant();
    if (!std::isfinite(determinant) || std::abs(determinant) < kLeastDeterminant) failPrimaries(p);
    return xyz;
}

// Scales cone responses so that one white becomes the other.
Imath::M33d adaptation(const Primaries::Xy& from, const Primaries::Xy& to) {
    const Imath::M33d cones = transposed(kBradford);
    const auto white = [&](const Primaries::Xy& xy) {
        return Imath::V3d(xy[0] / xy[1], 1, (1 - xy[0] - xy[1]) / xy[1]) * cones;
    };
    const Imath::V3d a = white(from), b = white(to);
    Imath::M33d scale;
    for (int i = 0; i < 3; ++i) scale[i][i] = b[i] / a[i];
    return cones * scale * cones.inverse();
}

}  // namespace

std::optional<ColorMatrix> toRec709(const Primaries& from, const Primaries::Xy& neutral) {
    const Primaries rec709;
    if (near(from.red, rec709.red) && near(from.green, rec709.green) && near(from.blue, rec709.blue) &&
        near(from.white, rec709.white) && near(neutral, rec709.white))
        return std::nullopt;
    const Imath::M33d m = toXyz(from) * adaptation(neutral, rec709.white) * toXyz(rec709).inverse();
    ColorMatrix rows;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            if (!std::isfinite(m[r][c])) failPrimaries(from);
            rows[size_t(c)][size_t(r)] = m[r][c];
        }
    return rows;
}

std::array<double, 3> luminanceWeights(const Primaries& primaries) {
    const Imath::M33d xyz = toXyz(primaries);
    const double sum = xyz[0][1] + xyz[1][1] + xyz[2][1];
    return {xyz[0][1] / sum, xyz[1][1] / sum, xyz[2][1] / sum};
}

}  // namespace tilefarm
