#include "worker/render/hidden_lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_scenes.h"

namespace tilefarm {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

/// A lamp beside a ball of glass.
struct HiddenLights : testing::Test {
    HiddenLights() {
        addMesh(scene, sphereMesh(4), matte(glm::vec3(1)));
        Material glass = matte(glm::vec3(1));
        glass.name = "Glass";
        glass.ior = 1.5f;
        glass.roughness = 0;
        glass.transmission = glass.thickness = 1;
        addMesh(scene, sphereMesh(4), glass);
        scene.lights.resize(1);
    }
    std::vector<SceneWarning> warnings() const { return hiddenLights(scene, settings); }
    Material& glass() { return scene.materials[1]; }

    Scene scene;
    RenderSettings settings;
};

TEST_F(HiddenLights, AreSaidWithTheGlassThatHidesThem) {
    ASSERT_THAT(warnings(), SizeIs(1));
    EXPECT_EQ(warnings()[0].where, "materials/1 (Glass)");
    scene.lights[0].type = PunctualType::directional;
    EXPECT_THAT(warnings(), SizeIs(1));
    settings.integrator = Integrator::whitted;
    EXPECT_THAT(warnings(), SizeIs(1));
}

TEST_F(HiddenLights, AreNoneOfWhatAPathFinds) {
    scene.lights[0].type = PunctualType::directional;
    scene.lights[0].angularRadius = 0.005f;
    EXPECT_THAT(warnings(), IsEmpty()) << "a sun of some size";
    scene.lights.clear();
    EXPECT_THAT(warnings(), IsEmpty());
}

TEST_F(HiddenLights, AreNoneBehindGlassThatLetsThemThrough) {
    glass().roughness = 0.4f;
    EXPECT_THAT(warnings(), IsEmpty()) << "paths find them at the glass itself";
    glass().roughness = 0;
    glass().thickness = 0;
    EXPECT_THAT(warnings(), IsEmpty());
    glass().thickness = 1;
    scene.meshes[1].open = true;
    EXPECT_THAT(warnings(), IsEmpty()) << "thin, since it encloses nothing";
}

TEST_F(HiddenLights, AreNoneWhereNothingIsInShadowOrAllIsRough) {
    settings.integrator = Integrator::raster;
    EXPECT_THAT(warnings(), IsEmpty());
    settings.integrator = Integrator::path;
    settings.regularisation = 0.1;
    EXPECT_THAT(warnings(), IsEmpty());
}

}  // namespace
}  // namespace tilefarm
