#include "shared/image/tone.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "shared/error/error.h"

namespace tilefarm {

namespace {

using Rgb = std::array<float, 3>;

struct Word {
    ToneCurve curve;
    std::string_view word;
};
constexpr std::array kWords{
    Word{ToneCurve::linear, "linear"},
    Word{ToneCurve::aces, "aces"},
    Word{ToneCurve::pbrNeutral, "pbrNeutral"},
};

// Narkowicz 2015, "ACES filmic tone mapping curve".
float aces(float x) {
    return x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
}

// Khronos PBR Neutral tone mapper, specification 1.0.
Rgb pbrNeutral(Rgb color) {
    constexpr float startCompression = 0.8f - 0.04f, desaturation = 0.15f;
    const float least = std::min({color[0], color[1], color[2]});
    const float offset = least < 0.08f ? least - 6.25f * least * least : 0.04f;  // of a dielectric's F0
    for (float& c : color) c -= offset;
    const float peak = std::max({color[0], color[1], color[2]});
    if (peak < startCompression) return color;

    constexpr float room = 1.f - startCompression;
    const float newPeak = 1.f - room * room / (peak + room - startCompression);
    const float toWhite = 1.f - 1.f / (desaturation * (peak - newPeak) + 1.f);
    for (float& c : color) c = std::lerp(c * (newPeak / peak), newPeak, toWhite);
    return color;
}

unsigned char encodeSrgb(float linear) {
    const float x = std::clamp(linear, 0.f, 1.f);
    const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.f / 2.4f) - 0.055f;
    return static_cast<unsigned char>(encoded * 255.f + 0.5f);
}

// NaN and negative light show black; the cap keeps the curves' squares finite.
float displayable(float value) {
    return value > 0 ? std::min(value, 1e10f) : 0.f;
}

}  // namespace

std::string_view toString(ToneCurve curve) {
    for (const Word& w : kWords)
        if (w.curve == curve) return w.word;
    throw Error(ErrorCode::internal, "a tone curve without a word");
}

ToneCurve toneCurveFrom(std::string_view word) {
    std::string known;
    for (const Word& w : kWords) {
        if (w.word == word) return w.curve;
        known += (known.empty() ? "" : ", ") + std::string(w.word);
    }
    throw Error(ErrorCode::invalidArgument,
                "'" + std::string(word) + "' is no tone curve; there are " + known);
}

std::array<unsigned char, 3> toDisplay(const Rgb& radiance, const ToneMapping& mapping) {
    const float scale = std::exp2(mapping.exposure);
    Rgb color{};
    for (size_t c = 0; c < 3; ++c) color[c] = displayable(radiance[c] * scale);
    switch (mapping.curve) {
        case ToneCurve::linear: break;
        case ToneCurve::aces:
            for (float& c : color) c = aces(c);
            break;
        case ToneCurve::pbrNeutral: color = pbrNeutral(color); break;
    }
    return {encodeSrgb(color[0]), encodeSrgb(color[1]), encodeSrgb(color[2])};
}

}  // namespace tilefarm
