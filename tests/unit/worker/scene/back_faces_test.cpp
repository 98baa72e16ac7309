#include "worker/scene/back_faces.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/support/test_scenes.h"

namespace tilefarm {
namespace {

CameraPath at(const glm::dvec3& eye, const glm::dvec3& target) {
    return {{cameraAt(eye, target, 1)}, std::nullopt};
}

Scene of(const Mesh& mesh, const Material& material = matte(glm::vec3(1)),
         const glm::dmat4& toWorld = glm::dmat4(1)) {
    Scene scene;
    addMesh(scene, mesh, material, toWorld);
    return scene;
}

bool mayBeSeen(const Scene& scene, const CameraPath& path) {
    return BackFaces(scene, flatten(scene)).mayBeSeen(path);
}

const Mesh kFloor = quadMesh({-1, 0, 1}, {2, 0, 0}, {0, 0, -2});  // faces up

TEST(BackFaces, OfAFlatFaceAreSeenFromItsBackAlone) {
    EXPECT_FALSE(mayBeSeen(of(kFloor), at({0, 1, 0.1}, {0, 0, 0})));
    EXPECT_TRUE(mayBeSeen(of(kFloor), at({0, -1, 0.1}, {0, 0, 0})));
    EXPECT_TRUE(mayBeSeen(of(kFloor), at({0, 0, 3}, {0, 0, 0}))) << "edge on: rounding decides";
    CameraPath flat = at({0, 1, 0.1}, {0, 0, 0});
    flat.keys[0].orthographic = true;
    EXPECT_FALSE(mayBeSeen(of(kFloor), flat));
    flat = at({0, 1, 0}, {0, 1, 1});
    flat.keys[0].orthographic = true;
    EXPECT_TRUE(mayBeSeen(of(kFloor), flat));
}

TEST(BackFaces, OfClosedSurfacesAreSeenFromWithinAlone) {
    for (const Mesh& mesh : {cubeMesh(false), sphereMesh(8)}) {
        EXPECT_FALSE(mayBeSeen(of(mesh), at({0, 0.5, 4}, {0, 0, 0})));
        EXPECT_TRUE(mayBeSeen(of(mesh), at({0, 0.1, 0.2}, {0, 0, 0})));
        CameraPath flat = at({0, 0, 0.5}, {0, 0, 0});
        flat.keys[0].orthographic = true;
        EXPECT_TRUE(mayBeSeen(of(mesh), flat));
        CameraPath clipped = at({0, 0.5, 4}, {0, 0, 0});
        clipped.keys[0].znear = 4;
        EXPECT_FALSE(mayBeSeen(of(mesh), clipped));
        clipped.keys[0].clips = true;
        EXPECT_TRUE(mayBeSeen(of(mesh), clipped));
    }
    EXPECT_TRUE(mayBeSeen(of(cubeMesh(true)), at({0, 0.5, 4}, {0, 0, 0}))) << "inside out";
}

TEST(BackFaces, OfClosedSurfacesWithHolesMayBeSeen) {
    Mesh open = cubeMesh(false);
    open.triangles.pop_back();
    EXPECT_TRUE(mayBeSeen(of(open), at({0, 0.5, 4}, {0, 0, 0})));
    Material cutOut = matte(glm::vec3(1));
    cutOut.alphaMode = AlphaMode::mask;
    EXPECT_TRUE(mayBeSeen(of(cubeMesh(false), cutOut), at({0, 0.5, 4}, {0, 0, 0})));
}

TEST(BackFaces, FollowMirroredNodes) {
    const glm::dmat4 mirrored = glm::scale(glm::dmat4(1), glm::dvec3(-1, 1, 1));
    EXPECT_FALSE(mayBeSeen(of(kFloor, matte(glm::vec3(1)), mirrored), at({0, 1, 0.1}, {0, 0, 0})));
    EXPECT_TRUE(mayBeSeen(of(kFloor, matte(glm::vec3(1)), mirrored), at({0, -1, 0.1}, {0, 0, 0})));
    EXPECT_FALSE(mayBeSeen(of(cubeMesh(false), matte(glm::vec3(1)), mirrored), at({0, 0.5, 4}, {0, 0, 0})));
}

TEST(BackFaces, AreNotThoseOfDoubleSidedMaterialsAndVolumesAndLights) {
    Material both = matte(glm::vec3(1)), solid = both;
    both.doubleSided = true;
    solid.transmission = solid.thickness = 1;
    for (const Material& material : {both, solid})
        EXPECT_FALSE(mayBeSeen(of(kFloor, material), at({0, -1, 0.1}, {0, 0, 0})));
    Scene scene;
    scene.areaLights.emplace_back();
    scene.areaLights.emplace_back().shape = AreaShape::sphere;
    EXPECT_FALSE(BackFaces(scene, flatten(scene)).any());
}

}  // namespace
}  // namespace tilefarm
