#include "shared/image/tone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

using Display = std::array<unsigned char, 3>;

Display grey(float radiance, ToneCurve curve, float exposure = 0) {
    return toDisplay({radiance, radiance, radiance}, {curve, exposure});
}
Display all(unsigned char value) {
    return {value, value, value};
}

TEST(ToneCurve, LinearIsTheSrgbEncoding) {
    // IEC 61966-2-1: the end of the toe, a middle value, half.
    EXPECT_EQ(grey(0.f, ToneCurve::linear), all(0));
    EXPECT_EQ(grey(0.0031308f, ToneCurve::linear), all(10));
    EXPECT_EQ(grey(0.2158605f, ToneCurve::linear), all(128));
    EXPECT_EQ(grey(0.5f, ToneCurve::linear), all(188));
    EXPECT_EQ(grey(1.f, ToneCurve::linear), all(255));
    EXPECT_EQ(grey(7.f, ToneCurve::linear), all(255));
}

TEST(ToneCurve, EveryDisplayValueSurvivesDecodingAndEncoding) {
    for (int v = 0; v < 256; ++v) {
        const double s = v / 255.0;
        const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
        EXPECT_EQ(grey(static_cast<float>(linear), ToneCurve::linear), all(static_cast<unsigned char>(v)));
    }
}

TEST(ToneCurve, AcesTakesTheValuesOfItsFit) {
    EXPECT_EQ(grey(0.f, ToneCurve::aces), all(0));
    EXPECT_EQ(grey(1.f, ToneCurve::aces), all(232));    // 2.54 / 3.16 = 0.8038
    EXPECT_EQ(grey(0.18f, ToneCurve::aces), all(141));  // 0.086724 / 0.324932 = 0.2669
    EXPECT_EQ(grey(1e9f, ToneCurve::aces), all(255));   // 2.51 / 2.43, clipped
}

TEST(ToneCurve, PbrNeutralTakesTheValuesOfItsSpecification) {
    EXPECT_EQ(grey(0.f, ToneCurve::pbrNeutral), all(0));
    EXPECT_EQ(grey(0.5f, ToneCurve::pbrNeutral), all(181));  // 0.5 - 0.04, not compressed
    EXPECT_EQ(grey(10.f, ToneCurve::pbrNeutral), all(254));  // 1 - 0.24² / 9.44
    // Saturated red of 4: no offset, since the least component is 0; peak 1 - 0.24²/3.48 = 0.98345,
    // then 0.31152 of the way to white.
    const Display red = toDisplay({4, 0, 0}, {ToneCurve::pbrNeutral, 0});
    EXPECT_EQ(red[0], 253);
    EXPECT_EQ(red[1], 150);
    EXPECT_EQ(red[1], red[2]);
}

TEST(ToneCurve, NeverGetsDarkerWithMoreLight) {
    for (const ToneCurve curve : {ToneCurve::linear, ToneCurve::aces, ToneCurve::pbrNeutral}) {
        unsigned char before = 0;
        for (float x = 1e-4f; x < 1e6f; x *= 1.05f) {
            ASSERT_GE(grey(x, curve)[0], before) << toString(curve) << " at " << x;
            before = grey(x, curve)[0];
        }
    }
}

TEST(ToneCurve, ExposureIsInStops) {
    for (const ToneCurve curve : {ToneCurve::linear, ToneCurve::aces, ToneCurve::pbrNeutral}) {
        EXPECT_EQ(grey(0.1f, curve, 2), grey(0.4f, curve));
        EXPECT_EQ(grey(0.8f, curve, -3), grey(0.1f, curve));
    }
}

TEST(ToneCurve, ShowsWhatIsNoLightBlackAndTooMuchWhite) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const ToneCurve curve : {ToneCurve::linear, ToneCurve::aces, ToneCurve::pbrNeutral}) {
        EXPECT_EQ(grey(nan, curve), all(0));
        EXPECT_EQ(grey(-inf, curve), all(0));
        EXPECT_EQ(grey(-1.f, curve), all(0));
        EXPECT_EQ(grey(inf, curve), all(255));
        EXPECT_EQ(grey(std::numeric_limits<float>::max(), curve, 100), all(255));
    }
}

TEST(ToneCurve, WordsNameCurves) {
    for (const ToneCurve curve : {ToneCurve::linear, ToneCurve::aces, ToneCurve::pbrNeutral})
        EXPECT_EQ(toneCurveFrom(toString(curve)), curve);
    EXPECT_EQ(codeOf([] { toneCurveFrom("filmic"); }), ErrorCode::invalidArgument);
}

}  // namespace
}  // namespace tilefarm
