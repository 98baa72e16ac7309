#include <gmock/gmock.h>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/support/expect_error.h"
#include "worker/scene/load.h"
#include "worker/scene/view.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

Scene boxScene(glm::vec3 lower, glm::vec3 upper) {
    Scene scene;
    scene.materials.emplace_back();
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.emplace_back(i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y,
                                    i & 4 ? upper.z : lower.z);
    }
    mesh.triangles = {{0, 1, 2}};
    scene.meshes.push_back(mesh);
    scene.instances.push_back({0, glm::dmat4(1), "box"});
    return scene;
}

/// Largest |x| / halfWidth and |y| / halfHeight on the image plane over the corners; below 1 is in the
/// picture.
double farthestOut(const Camera& camera, const Scene& scene, double aspect) {
    const glm::dmat4 toCamera = glm::inverse(camera.toWorld);
    const double half = std::tan(camera.yfov / 2.0);
    double farthest = 0;
    for (glm::vec3 position : scene.meshes[0].positions) {
        const glm::dvec4 p = toCamera * scene.instances[0].toWorld * glm::dvec4(position, 1);
        EXPECT_LT(p.z, 0) << "in front";
        farthest = std::max({farthest, std::abs(p.x / -p.z) / (half * aspect), std::abs(p.y / -p.z) / half});
    }
    return farthest;
}

TEST(FramingCamera, SeesAllOfAnySceneInAnyShapeOfPicture) {
    for (double size : {1e-6, 1.0, 1e6}) {
        for (double aspect : {0.3, 1.0, 2.5}) {
            for (glm::vec3 shape : {glm::vec3(1, 1, 1), glm::vec3(10, 0.1, 1), glm::vec3(0.1, 1, 20)}) {
                Scene scene = boxScene(-shape * float(size), shape * float(size));
                scene.instances[0].toWorld = glm::translate(glm::dmat4(1), {3, -70, 5});
                const double out = farthestOut(framingCamera(scene, aspect), scene, aspect);
                EXPECT_LT(out, 1) << size << " " << aspect;
                EXPECT_GT(out, 0.3) << size << " " << aspect;
            }
        }
    }
}

TEST(FramingCamera, LooksFromTheFrontAndABitFromAbove) {
    const Camera camera = framingCamera(boxScene(glm::vec3(-1), glm::vec3(1)), 1.5);
    EXPECT_GT(camera.toWorld[3].z, camera.toWorld[3].x);
    EXPECT_GT(camera.toWorld[3].x, 0);
    EXPECT_GT(camera.toWorld[3].y, 0);
    EXPECT_NEAR(camera.toWorld[0].y, 0, 1e-12) << "level";
    EXPECT_NEAR(glm::determinant(camera.toWorld), 1, 1e-12);
    EXPECT_NEAR(camera.yfov, 0.6981317, 1e-6);
}

TEST(FramingCamera, TakesScenesOfNothingAndOfOnePoint) {
    Scene empty;
    EXPECT_TRUE(std::isfinite(framingCamera(empty, 1).toWorld[3].z));
    const Scene point = boxScene(glm::vec3(5), glm::vec3(5));
    EXPECT_LT(farthestOut(framingCamera(point, 1), point, 1), 1);
}

TEST(SelectCamera, FindsByCameraThenByNodeName) {
    Scene scene = boxScene(glm::vec3(-1), glm::vec3(1));
    EXPECT_EQ(selectCamera(scene, "auto", 1).name, "framing");
    Camera first, second;
    first.name = "Wide";
    first.node = "Tripod";
    second.name = second.node = "Drone";
    scene.cameras = {first, second};
    EXPECT_EQ(selectCamera(scene, "auto", 1).name, "Wide");
    EXPECT_EQ(selectCamera(scene, "Tripod", 1).name, "Wide");
    EXPECT_EQ(selectCamera(scene, "Drone", 1).name, "Drone");
    const Error error = errorOf([&] { selectCamera(scene, "Boat", 1); });
    EXPECT_EQ(error.code, ErrorCode::invalidArgument);
    EXPECT_THAT(error.what(), HasSubstr(R"(no camera "Boat"; it has "Wide" at "Tripod", "Drone")"));
}

/// Half width and half height of the picture at a distance of 1, as a camera without a lens gives them.
std::pair<double, double> seen(Camera camera, CameraFit fit, double imageAspect) {
    camera = fitted(camera, fit, imageAspect);
    const double half = camera.orthographic ? camera.ymag : std::tan(camera.yfov / 2.0);
    return {half * imageAspect, half};
}

TEST(FittedCamera, ShowsTheWholeViewOrNothingBeyondIt) {
    Camera camera;
    camera.aspect = 2;
    camera.yfov = 2 * std::atan(0.5f);  // the view is 2 by 1
    for (const bool flat : {false, true}) {
        camera.orthographic = flat;
        camera.xmag = 1, camera.ymag = 0.5f;
        const auto expect = [&](CameraFit fit, double aspect, double width, double height) {
            const auto [x, y] = seen(camera, fit, aspect);
            EXPECT_NEAR(2 * x, width, 1e-6) << "fit " << int(fit) << " aspect " << aspect << " flat " << flat;
            EXPECT_NEAR(2 * y, height, 1e-6)
                << "fit " << int(fit) << " aspect " << aspect << " flat " << flat;
        };
        expect(CameraFit::fit, 1, 2, 2);
        expect(CameraFit::fit, 4, 4, 1);
        expect(CameraFit::fill, 1, 1, 1);
        expect(CameraFit::fill, 4, 2, 0.5);
        expect(CameraFit::vertical, 1, 1, 1);
        expect(CameraFit::vertical, 4, 4, 1);
        expect(CameraFit::horizontal, 1, 2, 2);
        expect(CameraFit::horizontal, 4, 2, 0.5);
    }
}

TEST(FittedCamera, KeepsItsBitsWhereTheAspectsAgreeOrNoneIsKnown) {
    Camera camera;
    camera.yfov = 0.7f;
    for (const float aspect : {0.f, 1.7777778f, 1.77778f}) {
        camera.aspect = aspect;
        for (const CameraFit fit :
             {CameraFit::fit, CameraFit::fill, CameraFit::horizontal, CameraFit::vertical})
            EXPECT_EQ(fitted(camera, fit, 1920.0 / 1080).yfov, 0.7f) << aspect;
    }
}

}  // namespace
}  // namespace tilefarm
