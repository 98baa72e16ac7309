// Properties of any transform: scenes under chains of nodes from far away, of any size, stretched, mirrored
// and turned, through the loader and whole renders.
#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <ostream>

#include "tests/numerics/picture.h"
#include "tests/property/holds.h"
#include "tests/shader/device_fixture.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

/// Beyond it, a deviation is none of chance: two-sided 5e-9.
constexpr double kLimit = 5.85;

/// A node of a chain.
struct Step {
    glm::dvec3 translation{0}, scale{1};
    glm::dvec3 axis{0, 1, 0};
    double angle = 0;  // rad

    glm::dmat4 matrix() const {
        return glm::scale(glm::rotate(glm::translate(glm::dmat4(1), translation), angle, axis), scale);
    }
};
using Chain = std::vector<Step>;  // from the root down

std::ostream& operator<<(std::ostream& out, const Step& s) {
    out << "{";
    if (s.translation != glm::dvec3(0))
        out << "move " << s.translation.x << " " << s.translation.y << " " << s.translation.z << " ";
    if (s.angle != 0)
        out << "turn " << s.angle << " around " << s.axis.x << " " << s.axis.y << " " << s.axis.z << " ";
    if (s.scale != glm::dvec3(1)) out << "scale " << s.scale.x << " " << s.scale.y << " " << s.scale.z;
    return out << "}";
}

glm::dmat4 matrixOf(const Chain& chain) {
    glm::dmat4 m(1);
    for (const Step& step : chain) m *= step.matrix();
    return m;
}

constexpr int kSteps = 1000;

/// 10^e; half the time 1.
double tenTo(int code, double least, double most) {
    return code < kSteps / 2 ? 1 : std::pow(10, least + (most - least) * (2.0 * code / kSteps - 1));
}

/// `similar`: of a scale that is alike in all directions and mirrors nothing.
Step stepOf(const std::vector<int>& c, bool similar, double mostScale) {
    Step s;
    for (int i = 0; i < 3; ++i)
        s.translation[i] =
            c[i] < kSteps / 3 ? 0 : (c[i] % 2 ? 1 : -1) * std::pow(10, 7.0 * c[i] / kSteps - 1);
    if (c[3] > kSteps / 3) {
        s.angle = 6.283 * c[3] / kSteps;
        s.axis = glm::normalize(
            glm::dvec3(c[4] - kSteps / 2 + 0.5, c[5] - kSteps / 2 + 0.5, c[6] - kSteps / 2 + 0.5));
    }
    for (int i = 0; i < 3; ++i) {
        s.scale[i] = tenTo(c[7 + (similar ? 0 : i)], -mostScale, mostScale);
        if (!similar && c[10 + i] > 2 * kSteps / 3) s.scale[i] = -s.scale[i];
    }
    return s;
}

/// Up to `most` nodes; all scales but one near 1, so that their product stays within 1e-4 to 1e4 or so.
rc::Gen<Chain> anyChain(int most, bool similar) {
    const auto codes = rc::gen::container<std::vector<int>>(13, rc::gen::inRange(0, kSteps));
    const auto all =
        rc::gen::container<std::vector<std::vector<int>>>(rc::gen::resize(rc::kNominalSize, codes));
    return rc::gen::map(rc::gen::resize(most, all), [similar](const std::vector<std::vector<int>>& nodes) {
        Chain chain;
        for (const auto& node : nodes) {
            chain.push_back(stepOf(node, similar, chain.empty() ? 4 : 0.02));
            // Below the first node the scene's own size counts.
            if (chain.size() > 1) chain.back().translation *= 1e-6;
        }
        return chain;
    });
}

/// Meshes at the end of a chain of nodes, matte and white, in the light of a white sky.
Scene sceneUnder(const Chain& chain, const std::vector<Mesh>& meshes, const std::filesystem::path& folder) {
    GltfBuilder builder;
    std::string leaves;
    uint32_t index = 0;
    for (const Mesh& mesh : meshes) {
        const std::string primitive = fmt::format("/meshes/{}/primitives/0/", index);
        builder.set(primitive + "attributes/POSITION", builder.accessor(mesh.positions));
        std::vector<uint32_t> corners;
        for (const glm::uvec3& t : mesh.triangles) corners.insert(corners.end(), {t.x, t.y, t.z});
        builder.set(primitive + "indices", builder.accessor(corners, "SCALAR"));
        builder.set(fmt::format("/nodes/{}/mesh", index), index);
        leaves += fmt::format("{}{}", index == 0 ? "" : ", ", index);
        ++index;
    }
    for (size_t i = chain.size(); i-- > 0; ++index) {
        const Step& s = chain[i];
        const double half = std::sin(s.angle / 2);
        builder.set(
            fmt::format("/nodes/{}", index),
            fmt::format(R"({{"children": [{}], "translation": [{}, {}, {}], "rotation": [{}, {}, {}, {}],
                                    "scale": [{}, {}, {}]}})",
                        leaves, s.translation.x, s.translation.y, s.translation.z, half * s.axis.x,
                        half * s.axis.y, half * s.axis.z, std::cos(s.angle / 2), s.scale.x, s.scale.y,
                        s.scale.z));
        leaves = std::to_string(index);
    }
    builder.set("/scenes/0/nodes", "[" + leaves + "]");
    Scene scene = loadGltf(builder.writeGlb(folder, "scene.glb"));
    for (Material& material : scene.materials) material = matte(glm::vec3(1));
    scene.environment = uniformEnvironment(glm::vec3(1));
    return scene;
}

class AnyTransform : public DeviceTest {
protected:
    Picture shown(const Scene& scene, const Camera& camera) {
        return render(device, scene, camera, {.size = 12, .samples = 16, .maxBounces = 8});
    }

    std::string cubeInWhiteLightIsWhite(const Chain& chain);
    std::string movesWithItsCamera(const Chain& chain);
    void expectSoundTransforms(int cases, int nodes);

    TemporaryFolder folder_;
    std::optional<Picture> unmoved_;
};

std::string soundOf(const Picture& picture) {
    std::string faults;
    if (!allFinite(picture)) faults += "not finite\n";
    if (picture.stats.droppedSamples != 0)
        faults += fmt::format("{} samples dropped\n", picture.stats.droppedSamples);
    return faults;
}

/// A convex white surface returns what comes, whatever its shape.
std::string AnyTransform::cubeInWhiteLightIsWhite(const Chain& chain) {
    const glm::dmat4 m = matrixOf(chain);
    const Mesh cube = cubeMesh(false);
    const glm::dvec3 centre(m[3]);
    double radius = 0;
    for (const glm::vec3& p : cube.positions)
        radius = std::max(radius, glm::length(glm::dvec3(m * glm::dvec4(p, 1)) - centre));
    const Camera camera =
        cameraAt(centre + 3 * radius * glm::normalize(glm::dvec3(0.5, 0.7, 0.6)), centre, 0.6);
    const Picture picture = shown(sceneUnder(chain, {cube}, folder_.path()), camera);
    std::string faults = soundOf(picture);
    if (std::none_of(picture.pixels.begin(), picture.pixels.end(), hit))
        return faults;  // too thin for a pixel
    const Mean mean = meanOf(picture, 0, hit);
    if (!(std::abs(mean.value - 1) <= kLimit * mean.sigma + 1e-4))
        faults += fmt::format("a white cube shows {} ± {}\n", mean.value, mean.sigma);
    return faults;
}

/// A scene and its camera moved, turned and scaled alike show the same picture: the same paths where they are
/// not turned (a direction's frame goes by the world's axes), else the same but for noise.
std::string AnyTransform::movesWithItsCamera(const Chain& chain) {
    const std::vector<Mesh> meshes{cubeMesh(false), quadMesh({-3, -1, 3}, {6, 0, 0}, {0, 0, -6})};
    const Camera at = cameraAt({2, 2.5, 4}, {0, 0, 0}, 0.7);
    if (!unmoved_) unmoved_ = shown(sceneUnder({}, meshes, folder_.path()), at);
    const glm::dmat4 m = matrixOf(chain);
    Camera camera = at;
    camera.toWorld = m * at.toWorld;
    bool turned = false;
    for (int i = 0; i < 3; ++i) camera.toWorld[i] = glm::normalize(camera.toWorld[i]);
    for (const Step& step : chain) turned = turned || step.angle != 0;
    const Picture picture = shown(sceneUnder(chain, meshes, folder_.path()), camera);
    std::string faults = soundOf(picture);
    const Mean a = meanOf(picture), b = meanOf(*unmoved_);
    const double off = relMse(picture, *unmoved_);
    if (!turned && !(off <= 1e-4)) faults += fmt::format("relMSE {}\n", off);
    if (!(std::abs(a.value - b.value) <= kLimit * std::hypot(a.sigma, b.sigma) + 1e-4))
        faults += fmt::format("mean {} ± {}, unmoved {} ± {}\n", a.value, a.sigma, b.value, b.sigma);
    return faults;
}

void AnyTransform::expectSoundTransforms(int cases, int nodes) {
    holds("a white cube under any transform is white", cases,
          [&] { require(cubeInWhiteLightIsWhite(*anyChain(nodes, false))); });
    holds("a scene that moves with its camera looks the same", cases,
          [&] { require(movesWithItsCamera(*anyChain(nodes, true))); });
}

TEST_F(AnyTransform, IsSound) {
    expectSoundTransforms(5, 6);
}
TEST_F(AnyTransform, FullIsSound) {
    expectSoundTransforms(40, 30);
}

}  // namespace
}  // namespace tilefarm
