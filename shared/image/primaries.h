#pragma once

#include <array>
#include <optional>

namespace tilefarm {

/// CIE 1931 x and y of the lights that R, G and B stand for, and of the white that they make together.
struct Primaries {
    using Xy = std::array<double, 2>;
    Xy red{0.64, 0.33}, green{0.3, 0.6}, blue{0.15, 0.06}, white{0.3127, 0.329};  // Rec. 709
    friend bool operator==(const Primaries&, const Primaries&) = default;
};

/// CIE XYZ themselves: white is 1 of each.
inline constexpr Primaries kXyzPrimaries{{1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}};

/// Rows of a matrix that takes a column of three values to another.
using ColorMatrix = std::array<std::array<double, 3>, 3>;

/// From linear values of `from` to linear Rec. 709, what is `neutral` to white by Bradford's chromatic
/// adaptation; none where nothing changes but for rounding. Entries are within 1e-6.
/// Throws Error(invalidArgument) where the primaries do not span all colours.
std::optional<ColorMatrix> toRec709(const Primaries& from, const Primaries::Xy& neutral);

/// Shares of R, G and B in the luminance Y; they add up to 1. Throws as toRec709.
std::array<double, 3> luminanceWeights(const Primaries& primaries);

}  // namespace tilefarm
