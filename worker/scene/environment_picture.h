#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/image/primaries.h"
#include "worker/scene/scene.h"

namespace tilefarm {

/// An environment as its file has it, equirectangular: what is no radiance is still in it.
struct EnvironmentPicture {
    Image image;                         // rgbaFloat, alpha 1
    std::optional<ColorMatrix> toScene;  // from the file's primaries to linear Rec. 709; none: they are
    /// What an infinite channel stands for: the largest value of its type, where larger ones became infinite;
    /// 0: nothing is known.
    std::array<float, 3> infinity{0, 0, 0};
    double aspect = 2;               // width by height as the file means it to be shown
    std::vector<std::string> notes;  // what of the file is passed over, for warnings
    std::vector<std::string> departures{};  // from its format, which other readers do not mind
};

/// An OpenEXR picture of R, G and B, of Y alone, or of Y, RY and BY. Its display window is the sphere and
/// black beyond the data window; a cube map becomes equirectangular.
EnvironmentPicture readExrEnvironment(const std::filesystem::path& path);
/// A Radiance picture (.hdr; RGBE or XYZE, flat or run-length encoded, rows from the top), divided by what
/// its header says it was multiplied by.
EnvironmentPicture decodeRadianceHdr(std::span<const std::byte> bytes);
/// A PNG or JPEG, sRGB; white is radiance 1, and black shows through where it is transparent.
EnvironmentPicture decodeDisplayPicture(std::span<const std::byte> bytes);
// All throw Error(invalidArgument) with the fault; the caller sees to it that it names the file.

}  // namespace tilefarm
