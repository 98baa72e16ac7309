#include "shared/job/job.h"
#include "worker/scene/sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "worker/scene/apply_job.h"
#include "worker/scene/atmosphere.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

double luminance(const glm::dvec3& c) {
    return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722));
}

glm::dvec3 towards(double elevation, double azimuth = 0) {
    const double e = elevation * pi / 180, a = azimuth * pi / 180;
    return {std::cos(e) * std::cos(a), std::sin(e), std::cos(e) * std::sin(a)};
}

SkySettings sunAt(double elevation, double turbidity = 1) {
    SkySettings settings;
    settings.sunElevation = elevation;
    settings.turbidity = turbidity;
    return settings;
}

glm::dvec3 texel(const Image& image, uint32_t x, uint32_t y) {
    const float* rgba = &image.rgbaFloat[4 * (size_t{y} * image.width + x)];
    return {rgba[0], rgba[1], rgba[2]};
}

/// On a horizontal plane, from the image's upper half.
glm::dvec3 skyIrradiance(const Image& image) {
    glm::dvec3 sum(0);
    for (uint32_t y = 0; y < image.height / 2; ++y) {
        const double theta = pi * (y + 0.5) / image.height;
        for (uint32_t x = 0; x < image.width; ++x)
            sum += texel(image, x, y) * (std::sin(theta) * std::cos(theta));
    }
    return sum * (pi / image.height) * (2 * pi / image.width);
}

TEST(Atmosphere, LosesAndReddensTheSunTowardsTheHorizon) {
    const Atmosphere air(2, 0.3);
    double before = 1;
    for (const double elevation : {90, 60, 30, 15, 5, 1}) {
        const glm::dvec3 through = air.transmittance(0, std::sin(elevation * pi / 180));
        EXPECT_LT(luminance(through), before) << elevation;
        before = luminance(through);
    }
    const glm::dvec3 sunset = air.transmittance(0, std::sin(2 * pi / 180));
    EXPECT_GT(sunset.r, 2 * sunset.g);
    EXPECT_GT(sunset.g, 5 * sunset.b);
    EXPECT_EQ(air.transmittance(0, -0.1), glm::dvec3(0)) << "the Earth is in the way";
}

TEST(Atmosphere, PureAirLosesWhatItsOpticalDepthSays) {
    // Rayleigh's τ is the coefficient times the scale height; ozone's the area of its layer, 15 km.
    const glm::dvec3 depth = glm::dvec3(5.802e-3, 13.558e-3, 33.1e-3) * 8.0 + glm::dvec3(0.650e-3, 1.881e-3, 0.085e-3) * 15.0;
    const glm::dvec3 through = Atmosphere(1, 0).transmittance(0, 1);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(through[c], std::exp(-depth[c]), 1e-3);
}

TEST(Atmosphere, ZenithIsBluerThanTheHorizon) {
    const Atmosphere air(1.5, 0.3);
    const glm::dvec3 sun = towards(40), zenith = air.radiance(0.001, towards(90), sun),
                     horizon = air.radiance(0.001, towards(2, 180), sun);
    EXPECT_GT(zenith.b / zenith.r, 1.5 * horizon.b / horizon.r);
    EXPECT_GT(zenith.b, zenith.g);
    EXPECT_GT(zenith.g, zenith.r);
    EXPECT_GT(luminance(horizon), luminance(zenith));
}

TEST(Atmosphere, AerosolBrightensTheSkyAroundTheSun) {
    const glm::dvec3 sun = towards(40), beside = towards(45);
    EXPECT_GT(luminance(Atmosphere(4, 0.3).radiance(0, beside, sun)),
              2 * luminance(Atmosphere(1, 0.3).radiance(0, beside, sun)));
}

TEST(Atmosphere, IsPositiveAndFiniteForEverySunAndTurbidity) {
    for (const double turbidity : {1, 3, 10}) {
        const Atmosphere air(turbidity, 1);
        for (double sun = -10; sun <= 90; sun += 5)
            for (const double up : {0.01, 1., 20., 90.})
                for (const double azimuth : {0, 60, 180}) {
                    const glm::dvec3 radiance = air.radiance(0.001, towards(up, azimuth), towards(sun));
                    for (int c = 0; c < 3; ++c) {
                        EXPECT_TRUE(std::isfinite(radiance[c]));
                        EXPECT_GT(radiance[c], 0) << turbidity << " sun " << sun << " up " << up;
                        EXPECT_LT(radiance[c], 3);
                    }
                }
    }
}

TEST(Sky, DiffuseAndDirectLightAreInTheProportionsOfAClearDay) {
    // At 60° and an aerosol optical depth near 0.1 clear-sky models and measurements give a horizontal diffuse share
    // of 0.1 to 0.25 of the direct light; near the zenith all together is near π, a white plane's radiance near 1.
    Scene scene;
    addSky(scene, sunAt(60, 2), 1, 0);
    ASSERT_EQ(scene.lights.size(), 1u);
    const double direct = luminance(scene.lights[0].color) * std::sin(60 * pi / 180),
                 diffuse = luminance(skyIrradiance(scene.environment.image));
    EXPECT_GT(diffuse / direct, 0.1);
    EXPECT_LT(diffuse / direct, 0.25);

    Scene noon;
    addSky(noon, sunAt(85), 1, 0);
    EXPECT_NEAR((luminance(noon.lights[0].color) * std::sin(85 * pi / 180) +
                 luminance(skyIrradiance(noon.environment.image))) / pi,
                1, 0.1);
}

TEST(Sky, IsTheSameOnBothSidesOfTheSun) {
    SkySettings settings = sunAt(20, 2);
    settings.sunAzimuth = 90;  // east, +x: the middle of the image
    Scene scene;
    addSky(scene, settings, 2, 0);
    const Image& image = scene.environment.image;
    for (uint32_t y = 0; y < image.height; y += 7)
        for (uint32_t x = 0; x < image.width / 2; x += 5)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(texel(image, x, y)[c], texel(image, image.width - 1 - x, y)[c],
                            1e-6 * texel(image, x, y)[c]);
    EXPECT_GT(luminance(texel(image, 256, 100)), luminance(texel(image, 0, 100))) << "brighter on the sun's side";
    EXPECT_GT(scene.lights[0].angularRadius, 0.004);
    EXPECT_NEAR(scene.lights[0].direction.x, -std::cos(20 * pi / 180), 1e-6);
    EXPECT_NEAR(scene.lights[0].direction.z, 0, 1e-6);
}

TEST(Sky, TurnsSunAndImageTogetherAndScalesBoth) {
    Scene plain, turned;
    SkySettings settings = sunAt(30);
    settings.sunAzimuth = 90;
    addSky(plain, settings, 1, 0);
    addSky(turned, settings, 3, pi / 2);
    EXPECT_NEAR(turned.lights[0].direction.z, std::cos(pi / 6), 1e-6) << "from east to north, counter-clockwise";
    EXPECT_EQ(turned.environment.rotation, pi / 2);
    EXPECT_NEAR(turned.lights[0].color.g, 3 * plain.lights[0].color.g, 1e-5);
    EXPECT_NEAR(texel(turned.environment.image, 10, 10).g, 3 * texel(plain.environment.image, 10, 10).g, 1e-5);
}

TEST(Sky, HasNoDiskWhenTheSunIsDownAndNoneWhenItIsNotWanted) {
    Scene night, diskless;
    addSky(night, sunAt(-3), 1, 0);
    EXPECT_TRUE(night.lights.empty());
    EXPECT_GT(luminance(skyIrradiance(night.environment.image)), 0) << "twilight";
    SkySettings settings = sunAt(30);
    settings.sunIntensity = 0;
    addSky(diskless, settings, 1, 0);
    EXPECT_TRUE(diskless.lights.empty());
}

TEST(Sky, IsWhatAJobGetsThatAsksForIt) {
    JobSpec job;
    job.environment.kind = EnvironmentKind::sky;
    job.environment.intensity = 2;
    job.environment.rotation = 90;
    job.environment.visible = false;
    Scene scene, expected;
    setJobEnvironment(scene, job, {});
    addSky(expected, job.environment.sky, 2, pi / 2);
    EXPECT_EQ(scene.environment.image.rgbaFloat, expected.environment.image.rgbaFloat);
    EXPECT_FALSE(scene.environment.visible);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].direction, expected.lights[0].direction);
}

}  // namespace
}  // namespace tilefarm
