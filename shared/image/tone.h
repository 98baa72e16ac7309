#pragma once

#include <array>
#include <string_view>

namespace tilefarm {

/// How linear radiance becomes a display value.
enum class ToneCurve {
    linear,      // clipped at 1
    aces,        // Narkowicz's fit of the ACES filmic curve
    pbrNeutral,  // Khronos PBR Neutral: base colours below 0.8 keep their look
};

std::string_view toString(ToneCurve curve);
/// Throws Error(invalidArgument) that lists the words there are.
ToneCurve toneCurveFrom(std::string_view word);

struct ToneMapping {
    ToneCurve curve = ToneCurve::pbrNeutral;
    float exposure = 0;  // stops: radiance is scaled by 2^exposure first
};

/// Linear Rec.709 radiance to sRGB-encoded 8 bit. NaN gives 0.
std::array<unsigned char, 3> toDisplay(const std::array<float, 3>& radiance, const ToneMapping& mapping);

}  // namespace tilefarm
