#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "shared/image/primaries.h"

namespace tilefarm {

/// What the lines before a Radiance picture's size say. Of a line that stands more than once the values
/// multiply, but of PRIMARIES the last counts.
struct RadianceHeader {
    std::array<double, 3> multipliedBy{1, 1, 1};  // EXPOSURE times COLORCORR, by channel
    std::optional<Primaries> primaries;
    bool xyz = false;        // FORMAT=32-bit_rle_xyze
    double pixelAspect = 1;  // PIXASPECT, height by width
    bool blanks = false;     // FORMAT has some round its value, which the format does not know

    /// Takes a line in; what is no "NAME=value" of these is passed over, as the reference wants it. Throws
    /// Error(invalidArgument) where its value cannot be used.
    void read(std::string_view line);
    /// From the picture's values, once divided, to linear Rec. 709.
    std::optional<ColorMatrix> toRec709() const;
};

}  // namespace tilefarm
