#include "worker/scene/view_warnings.h"

#include <gmock/gmock.h>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/support/test_scenes.h"

namespace tilefarm {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<SceneWarning> warningsOf(const Scene& scene, const Camera& camera,
                                     Culling culling = Culling::camera) {
    const WorldGeometry world = flatten(scene);
    return viewWarnings(scene, world, world.recentred(camera), 1, BackFaces(scene, world), culling);
}

auto warning(const char* feature, const std::string& instead) {
    return AllOf(Field(&SceneWarning::feature, feature), Field(&SceneWarning::instead, HasSubstr(instead)));
}

/// A wall of side 2 in z = `z` that faces +z.
void addWall(Scene& scene, double z, double x = 0) {
    addMesh(scene, quadMesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), matte(glm::vec3(1)),
            glm::translate(glm::dmat4(1), glm::dvec3(x, 0, z)));
    scene.instances.back().node = "wall at " + std::to_string(static_cast<int>(z));
}

TEST(ClippingWarnings, SayWhatLiesOutsideOfThePlanesInThePicture) {
    Scene scene;
    for (const double z : {0.0, -1.0, -9.0}) addWall(scene, z);
    Camera camera = cameraAt({0, 0, 1}, {0, 0, 0}, 1);
    EXPECT_THAT(warningsOf(scene, camera), IsEmpty());
    camera.znear = 0.5f, camera.zfar = 10;
    EXPECT_THAT(warningsOf(scene, camera), IsEmpty()) << "all within";
    camera.znear = 1.5f, camera.zfar = 9;
    EXPECT_THAT(warningsOf(scene, camera), ElementsAre(warning("znear", "node wall at 0 at 1 m"),
                                                       warning("zfar", "node wall at -9 at 10 m")));
    camera.clips = true;
    EXPECT_THAT(warningsOf(scene, camera), IsEmpty()) << "as asked for";
    camera.clips = false;
    camera.orthographic = true;
    EXPECT_EQ(warningsOf(scene, camera).size(), 2u);
}

TEST(ClippingWarnings, AreNotOfWhatThePictureDoesNotShow) {
    Scene scene;
    addWall(scene, 0, 5);
    addWall(scene, 3);
    addMesh(scene, quadMesh({-50, -1, 50}, {100, 0, 0}, {0, 0, -100}), matte(glm::vec3(1)));  // a floor below
    Camera camera = cameraAt({0, 0, 1}, {0, 0, 0}, 1);
    camera.znear = 1.8f;  // the floor enters the picture at 1 / tan(1/2) = 1.83 m
    EXPECT_THAT(warningsOf(scene, camera), IsEmpty());
    camera.znear = 1.9f;
    EXPECT_THAT(warningsOf(scene, camera), ElementsAre(warning("znear", "at 1.83049 m")));
}

TEST(CullingWarnings, SayHowMuchOfThePictureTheBacksWouldFill) {
    Scene scene;
    addWall(scene, 0);
    Camera camera = cameraAt({0, 0, -2}, {0, 0, 0}, 1);
    camera.orthographic = true;
    camera.ymag = 2;
    EXPECT_THAT(warningsOf(scene, camera), ElementsAre(warning("doubleSided", "about 25 % of the picture")));
    EXPECT_THAT(warningsOf(scene, camera, Culling::all), ElementsAre(warning("doubleSided", "no ray does")));
    EXPECT_THAT(warningsOf(scene, camera, Culling::none), IsEmpty());
    scene.materials.back().doubleSided = true;
    EXPECT_THAT(warningsOf(scene, camera), IsEmpty());
}

TEST(CullingWarnings, AreNotOfBacksBehindOtherFaces) {
    Scene scene;
    addMesh(scene, sphereMesh(8), matte(glm::vec3(1)));
    addWall(scene, 2);
    EXPECT_THAT(warningsOf(scene, cameraAt({0, 0, 4}, {0, 0, 0}, 1)), IsEmpty());
    Scene hidden;
    addMesh(hidden, quadMesh({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}), matte(glm::vec3(1)));
    const Mesh turnedAway = quadMesh({-1, -1, -1}, {0, 2, 0}, {2, 0, 0});
    addMesh(hidden, turnedAway, matte(glm::vec3(1)));
    EXPECT_THAT(warningsOf(hidden, cameraAt({0, 0, 4}, {0, 0, 0}, 1)), IsEmpty());
}

}  // namespace
}  // namespace tilefarm
