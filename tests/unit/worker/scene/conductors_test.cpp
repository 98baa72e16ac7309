#include "worker/scene/conductors.h"

#include <gtest/gtest.h>

namespace tilefarm {
namespace {

double reflectance(double eta, double k) {
    return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

glm::dvec3 colorOf(const char* name) {
    const Conductor metal = conductorNamed(name).value();
    glm::dvec3 color;
    for (int c = 0; c < 3; ++c) color[c] = reflectance(metal.eta[c], metal.k[c]);
    return color;
}

TEST(Conductors, KnowsMetalsByNameAndSynonymInAnyCase) {
    EXPECT_EQ(conductorNamed("Gold")->k, conductorNamed("au")->k);
    EXPECT_EQ(conductorNamed("aluminum")->eta, conductorNamed("aluminium")->eta);
    EXPECT_FALSE(conductorNamed("adamantium").has_value());
    EXPECT_FALSE(conductorNamed("").has_value());
}

TEST(Conductors, EveryNameIsAMetalThatReflectsMostLight) {
    EXPECT_GE(conductorNames().size(), 11u);
    for (const std::string_view name : conductorNames()) {
        const Conductor metal = conductorNamed(name).value();
        for (int c = 0; c < 3; ++c) {
            const double f = reflectance(metal.eta[c], metal.k[c]);
            EXPECT_GT(f, 0.35) << name;
            EXPECT_LT(f, 1) << name;
        }
    }
}

// Reflectances at normal incidence as handbooks give them.
TEST(Conductors, HaveTheColoursThatTheyAreKnownFor) {
    EXPECT_NEAR(colorOf("silver").g, 0.98, 0.01);
    EXPECT_NEAR(colorOf("aluminium").g, 0.91, 0.01);
    EXPECT_NEAR(colorOf("chromium").g, 0.55, 0.02);
    EXPECT_NEAR(colorOf("tungsten").g, 0.49, 0.02);
    const glm::dvec3 gold = colorOf("gold"), copper = colorOf("copper");
    EXPECT_GT(gold.r, 0.93);
    EXPECT_LT(gold.b, 0.45);
    EXPECT_GT(copper.r, 0.85);
    EXPECT_LT(copper.g, copper.r - 0.25);
}

}  // namespace
}  // namespace tilefarm
