// Cases 55 and 56: faces that share a part of their plane, opaque ones and those that light goes through.
#include <gtest/gtest.h>

#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/numerics/picture.h"
#include "tests/shader/device_fixture.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

class HardCoincidence : public DeviceTest {};

struct Place {
    double tilt = 0, height = 0, scale = 1;
};

/// To where a face in the plane y = 0 is placed: turned around an axis of no symmetry, so that no coordinate
/// is exact.
glm::dmat4 placed(const Place& at) {
    glm::dmat4 m = glm::scale(glm::dmat4(1), glm::dvec3(at.scale));
    m = glm::rotate(m, at.tilt, glm::normalize(glm::dvec3(0.3, 0.2, 0.9)));
    return glm::translate(m, glm::dvec3(0, at.height, 0));
}

std::ostream& operator<<(std::ostream& out, const Place& at) {
    return out << "tilt " << at.tilt << " height " << at.height << " scale " << at.scale;
}

using Places = std::vector<Place>;
const Places kFew{{0, 0, 1}, {1.1, 0.37, 1e4}}, kOne{{0, 0.37, 1}};  // one across an axis: boxes are flat
const Places kMany{{0, 0, 1},   {0, 0.37, 1}, {0.4, 0, 1},    {1.1, 0.37, 1},
                   {2, 0, 1e4}, {0, 0, 1e-4}, {0.7, -90, 10}, {std::numbers::pi / 2, 0, 1}};

Camera cameraOver(const glm::dmat4& place, const glm::dvec3& eye, double yfov) {
    return cameraAt(place * glm::dvec4(eye, 1), place * glm::dvec4(0.03, 0, 0.02, 1), yfov);
}

// ---- 55

Mesh squareMesh(float half, bool otherDiagonal) {
    Mesh mesh = quadMesh({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half});
    if (otherDiagonal) mesh.triangles = {{0, 1, 3}, {1, 2, 3}};
    return mesh;
}

Shape flatShape(ShapeKind kind, const glm::dvec3& size, const glm::dmat4& toWorld) {
    Shape shape;
    shape.kind = kind;
    shape.size = size;
    shape.toWorld = toWorld;
    return shape;
}

void addShape(Scene& scene, Shape shape, const Material& material) {
    shape.material = static_cast<uint32_t>(scene.materials.size());
    scene.materials.push_back(material);
    scene.shapes.push_back(std::move(shape));
}

/// From z to y.
glm::dmat4 lying(const glm::dmat4& place) {
    return glm::rotate(place, -std::numbers::pi / 2, glm::dvec3(1, 0, 0));
}

const Material kGrey = matte(glm::vec3(0.8f));

/// A sun 30° above the faces, which lets them shine by 0.8 sin 30° = 0.4.
void addSun(Scene& scene, const glm::dmat4& place) {
    PunctualLight sun;
    sun.type = PunctualType::directional;
    sun.color = glm::vec3(std::numbers::pi);
    const glm::dvec3 towards(place * glm::dvec4(std::cos(std::numbers::pi / 6), 0.5, 0, 0));
    sun.direction = glm::vec3(-glm::normalize(towards));
    scene.lights.push_back(sun);
}

void expectAsOneFace(const gpu::Device& device, Scene& scene, const Place& at) {
    const glm::dmat4 place = placed(at);
    addSun(scene, place);
    const Picture picture =
        render(device, scene, cameraOver(place, {0.3, 1.5, 1}, 0.5), {.size = 16, .samples = 4});
    for (const FilmPixel& pixel : picture.pixels)
        for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(pixel.mean[c], 0.4, 2e-5) << at;
}

void expectFloorsAndDecals(const gpu::Device& device, const Places& places) {
    bool decalFirst = false;
    for (const Place& at : places) {
        Scene scene;
        if (decalFirst) addMesh(scene, squareMesh(0.4f, false), kGrey, placed(at));
        addMesh(scene, squareMesh(5, false), kGrey, placed(at));
        addMesh(scene, squareMesh(5, true), kGrey, placed(at));
        // Turned into the plane, which rounding does not do exactly.
        addMesh(scene, quadMesh({-200, -200, 0}, {400, 0, 0}, {0, 400, 0}), kGrey, lying(placed(at)));
        if (!decalFirst) addMesh(scene, squareMesh(0.4f, false), kGrey, placed(at));
        expectAsOneFace(device, scene, at);
        decalFirst = !decalFirst;
    }
}

TEST_F(HardCoincidence, HardCase55_FloorsAndDecals) {
    expectFloorsAndDecals(device, kFew);
}

void expectCutOutDecals(const gpu::Device& device, const Places& places) {
    for (const Place& at : places)
        for (const AlphaMode mode : {AlphaMode::mask, AlphaMode::blend}) {
            Material decal = kGrey;
            decal.alphaMode = mode;
            decal.alpha = 0.6f;
            Scene scene;
            addMesh(scene, squareMesh(0.7f, true), decal, placed(at));
            addMesh(scene, squareMesh(5, false), kGrey, placed(at));
            addMesh(scene, squareMesh(0.4f, true), decal, placed(at));
            expectAsOneFace(device, scene, at);
        }
}

TEST_F(HardCoincidence, HardCase55_CutOutDecals) {
    expectCutOutDecals(device, kOne);
}

void expectFlatShapes(const gpu::Device& device, const Places& places) {
    for (const Place& at : places) {
        const glm::dmat4 place = placed(at);
        Scene scene;
        addMesh(scene, squareMesh(5, false), kGrey, place);
        addShape(scene, flatShape(ShapeKind::rectangle, {30, 40, 1}, lying(place)), kGrey);
        addShape(scene, flatShape(ShapeKind::disk, {0.5, 1, 1}, glm::translate(lying(place), {0.1, 0, 0})),
                 kGrey);
        addShape(scene, flatShape(ShapeKind::box, {0.3, 0.25, 0.2}, glm::translate(place, {0, -0.25, 0})),
                 kGrey);
        addShape(scene,
                 flatShape(ShapeKind::cylinder, {0.5, 0.2, 0.2}, glm::translate(place, {0.2, -0.5, 0})),
                 kGrey);
        expectAsOneFace(device, scene, at);
    }
}

TEST_F(HardCoincidence, HardCase55_Shapes) {
    expectFlatShapes(device, kFew);
}

TEST_F(HardCoincidence, HardCase55_AWallBesideAFloorStopsEveryRay) {
    // Faces that only meet at an edge are no coincident ones, beside others that are: in a closed room
    // nothing of the light outside is seen.
    Scene scene;
    addMesh(scene, cubeMesh(true), kGrey);
    addMesh(scene, squareMesh(1, true), kGrey, glm::translate(glm::dmat4(1), {0, -1, 0}));
    scene.environment = uniformEnvironment(glm::vec3(1e6f));
    const Picture picture = render(device, scene, cameraAt({0.5, -0.9, 0.5}, {-0.999, -0.999, -0.999}, 0.05),
                                   {.size = 32, .samples = 64});
    EXPECT_EQ(meanOf(picture).value, 0);
}

TEST_F(HardCoincidence, FullHardCase55_AnyPlace) {
    expectFloorsAndDecals(device, kMany);
    expectCutOutDecals(device, kMany);
    expectFlatShapes(device, kMany);
}

// ---- 56

Material glass(float ior, float thickness = 1) {
    Material m;
    m.metallic = 0;
    m.roughness = 0;
    m.transmission = 1;
    m.thickness = thickness;
    m.ior = ior;
    return m;
}

Material unlit(const glm::vec3& color) {
    Material m = matte(color);
    m.unlit = true;
    m.doubleSided = true;
    return m;
}

const glm::vec3 kGreen(0, 0.5f, 0);
const Shot kThroughGlass{.size = 12, .samples = 64, .maxBounces = 24, .rouletteStart = 24};

struct Part {
    Mesh mesh;
    Material material;
    glm::dmat4 toWorld{1};
};

/// The same from the first to the last and the other way round.
void inBothOrders(const gpu::Device& device, const std::vector<Part>& parts, const Camera& camera,
                  const Shot& shot, const std::function<void(const Picture&)>& expect) {
    std::vector<Picture> pictures;
    for (const bool reversed : {false, true}) {
        Scene scene;
        for (size_t i = 0; i < parts.size(); ++i) {
            const Part& part = parts[reversed ? parts.size() - 1 - i : i];
            addMesh(scene, part.mesh, part.material, part.toWorld);
        }
        scene.environment = uniformEnvironment(glm::vec3(1));
        pictures.push_back(render(device, scene, camera, shot));
        expect(pictures.back());
    }
    EXPECT_LE(furthestPixel(pictures[0], pictures[1]), 1e-5) << "the order of the file shows";
}

/// A block of glass on a green floor, by a gap.
std::vector<Part> blockOnFloor(const glm::dmat4& place, double gap, const Material& block) {
    return {{cubeMesh(false), block, glm::translate(place, {0, 1 + gap, 0})},
            {squareMesh(9, false), unlit(kGreen), place}};
}

void expectGlassOnAFloor(const gpu::Device& device, const Places& places) {
    for (const float thickness : {1.0f, 0.0f})  // solid, and walls of thin glass
        for (const Place& at : places) {
            const glm::dmat4 place = placed(at);
            const Camera camera = cameraOver(place, {0.1, 6, 0.2}, 0.2);
            Scene apart;
            for (const Part& part : blockOnFloor(place, 1e-3, glass(1.5f, thickness)))
                addMesh(apart, part.mesh, part.material, part.toWorld);
            apart.environment = uniformEnvironment(glm::vec3(1));
            const Picture expected = render(device, apart, camera, kThroughGlass);
            inBothOrders(device, blockOnFloor(place, 0, glass(1.5f, thickness)), camera, kThroughGlass,
                         [&](const Picture& p) {
                             for (int c = 0; c < 3; ++c)
                                 EXPECT_NEAR(meanOf(p, c).value, meanOf(expected, c).value, 2e-3) << at;
                         });
        }
}

TEST_F(HardCoincidence, HardCase56_GlassOnAFloor) {
    expectGlassOnAFloor(device, kOne);
}

TEST_F(HardCoincidence, HardCase56_AFloorHidesGlassFromBelow) {
    const Camera camera = cameraAt({0.1, -6, 0.2}, {0.03, 0, 0.02}, 0.2);
    inBothOrders(device, blockOnFloor(glm::dmat4(1), 0, glass(1.5f)), camera, {.size = 12, .samples = 4},
                 [](const Picture& picture) {
                     EXPECT_EQ(meanOf(picture, 1).value, 0.5);
                     EXPECT_EQ(meanOf(picture, 0).value, 0);
                 });
}

double brightestOf(const Picture& picture) {
    double most = 0;
    for (const FilmPixel& pixel : picture.pixels) most = std::max(most, double{pixel.mean[0]});
    recordWorst("most", most);
    return most;
}

/// Light of 1 from everywhere, and nothing that absorbs: 1 in every pixel, but for what the bounces cut off.
void expectFurnace(const gpu::Device& device, const std::vector<Part>& parts, const Camera& camera) {
    inBothOrders(device, parts, camera, {.size = 24, .samples = 32, .maxBounces = 128, .rouletteStart = 128},
                 [](const Picture& picture) {
                     EXPECT_LE(brightestOf(picture), 1 + 1e-4);
                     recordWorst("lost", 1 - meanOf(picture).value);
                     EXPECT_GE(meanOf(picture).value, 0.99);
                 });
}

Mesh insideOut(Mesh mesh) {
    for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
    for (glm::vec3& n : mesh.normals) n = -n;
    return mesh;
}

void expectLiquidThatTouches(const gpu::Device& device, const Places& places) {
    for (const Place& at : places) {
        const glm::dmat4 place = placed(at), inner = glm::scale(place, glm::dvec3(0.8));
        // What is outside of the glass and what is within it in one mesh.
        Mesh bottle = sphereMesh(12);
        const Mesh wall = insideOut(sphereMesh(12));
        const auto first = static_cast<uint32_t>(bottle.positions.size());
        for (const glm::vec3& p : wall.positions) bottle.positions.push_back(0.8f * p);
        for (const glm::uvec3& t : wall.triangles) bottle.triangles.push_back(t + first);
        bottle.normals.clear();
        bottle.uv0.clear();
        Mesh liquid = sphereMesh(12);
        liquid.normals.clear();
        expectFurnace(device, {{bottle, glass(1.5f), place}, {liquid, glass(1.33f), inner}},
                      cameraOver(place, {0.3, 4, 1}, 0.6));
    }
}

TEST_F(HardCoincidence, HardCase56_LiquidThatTouchesItsGlass) {
    expectLiquidThatTouches(device, kOne);
}

void expectBlocksAndFoil(const gpu::Device& device, const Places& places) {
    for (const Place& at : places) {
        const glm::dmat4 place = placed(at);
        const auto block = [&](double height, float ior) {
            return Part{cubeMesh(false), glass(ior), glm::translate(place, {0, height, 0})};
        };
        const Camera camera = cameraOver(place, {0.4, 7, 3}, 0.3);
        expectFurnace(device, {block(1, 1.5f), block(-1, 1.33f)}, camera);
        const Part foil{squareMesh(0.7f, true), glass(1.5f, 0), place};
        expectFurnace(device, {block(1, 1.5f), block(-1, 1.5f), foil}, camera);
    }
}

TEST_F(HardCoincidence, HardCase56_BlocksSideBySideAndFoilBetween) {
    expectBlocksAndFoil(device, kOne);
}

TEST_F(HardCoincidence, HardCase56_TouchingSolidsMakeOneInterface) {
    // Seen straight on, blocks of one index are one block.
    const auto through = [&](bool two) {
        Scene scene;
        if (two) {
            addMesh(scene, cubeMesh(false), glass(1.5f), glm::translate(glm::dmat4(1), {0, 0, 1}));
            addMesh(scene, cubeMesh(false), glass(1.5f), glm::translate(glm::dmat4(1), {0, 0, -1}));
        } else {
            addMesh(scene, cubeMesh(false), glass(1.5f), glm::scale(glm::dmat4(1), {1, 1, 2}));
        }
        addMesh(scene, quadMesh({-9, -9, -4}, {18, 0, 0}, {0, 18, 0}), matte(glm::vec3(0), glm::vec3(1)));
        scene.environment = uniformEnvironment(glm::vec3(0));
        return meanOf(render(device, scene, cameraAt({0, 0, 8}, {0, 0, 0}, 1e-4),
                             {.size = 16, .samples = 64, .maxBounces = 64, .rouletteStart = 64}));
    };
    const double f = 0.04, expected = (1 - f) / (1 + f);  // of a slab, all its reflections
    expectMean(through(false), expected, 1e-5);
    expectMean(through(true), expected, 1e-5);
}

void expectGlassBoxOnARectangle(const gpu::Device& device, const Places& places) {
    for (const Place& at : places) {
        const glm::dmat4 place = placed(at);
        const auto picture = [&](double gap, bool floorFirst) {
            Scene scene;
            const auto floor = [&] {
                addShape(scene, flatShape(ShapeKind::rectangle, {9, 9, 1}, lying(place)), unlit(kGreen));
            };
            if (floorFirst) floor();
            addShape(scene, flatShape(ShapeKind::box, {1, 1, 1}, glm::translate(place, {0, 1 + gap, 0})),
                     glass(1.5f));
            if (!floorFirst) floor();
            scene.environment = uniformEnvironment(glm::vec3(1));
            return render(device, scene, cameraOver(place, {0.1, 6, 0.2}, 0.2), kThroughGlass);
        };
        const Picture expected = picture(1e-3, false);
        for (const bool floorFirst : {false, true})
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(meanOf(picture(0, floorFirst), c).value, meanOf(expected, c).value, 2e-3)
                    << at << " floor first: " << floorFirst;
    }
}

TEST_F(HardCoincidence, HardCase56_Shapes) {
    expectGlassBoxOnARectangle(device, kOne);
}

TEST_F(HardCoincidence, HardCase56_RoundShapesOfOneSize) {
    // A ball of liquid that fills a hole of air in a ball of glass, as three shapes.
    Scene scene;
    for (const auto& [radius, ior] : {std::pair{1.0, 1.5f}, {0.8, 1.0f}, {0.8, 1.33f}}) {
        Shape ball;
        ball.size = glm::dvec3(radius);
        addShape(scene, ball, glass(ior));
    }
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Picture picture = render(device, scene, cameraAt({0.3, 1, 4}, {0, 0, 0}, 0.6),
                                   {.size = 24, .samples = 32, .maxBounces = 64, .rouletteStart = 64});
    EXPECT_LE(brightestOf(picture), 1 + 1e-4);
    EXPECT_GE(meanOf(picture).value, 0.999);
}

TEST_F(HardCoincidence, FullHardCase56_AnyPlace) {
    expectGlassOnAFloor(device, kMany);
    expectLiquidThatTouches(device, kMany);
    expectBlocksAndFoil(device, kMany);
    expectGlassBoxOnARectangle(device, kMany);
}

// ---- Files of others

TEST_F(HardCoincidence, SharedCases) {
    const std::filesystem::path cases = std::filesystem::path(TILEFARM_SOURCE_DIR) / "../shared/cases";
    if (!std::filesystem::exists(cases)) GTEST_SKIP() << "no shared cases beside the checkout";
    const auto picture = [&](const std::string& file, const Shot& shot) {
        Scene scene = loadGltf(cases / file);
        if (scene.lights.empty()) scene.environment = uniformEnvironment(glm::vec3(1));
        return render(device, scene, scene.cameras.at(0), shot);
    };
    for (const char* file : {"coplanar-floor-y0/floor1.gltf", "coplanar-floor-y0/floor2.gltf"})
        for (const FilmPixel& pixel : picture(file, {.size = 16, .samples = 4}).pixels)
            ASSERT_NEAR(pixel.mean[0], 0.4, 1e-5) << file;
    const Picture gap = picture("glass-on-floor-coincident/gap.gltf", kThroughGlass);
    for (const char* file :
         {"glass-on-floor-coincident/block-first.gltf", "glass-on-floor-coincident/floor-first.gltf"})
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(meanOf(picture(file, kThroughGlass), c).value, meanOf(gap, c).value, 2e-3) << file;
}

}  // namespace
}  // namespace tilefarm
