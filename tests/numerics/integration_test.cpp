// Cases 26, 31, 39, 40, 46, 48, 54: whole paths whose sum is known.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/numerics/picture.h"
#include "tests/shader/device_fixture.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class HardPath : public DeviceTest {};

Mesh turnedInwards(Mesh mesh) {
    for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
    return mesh;
}

Material glass(float ior, float roughness = 0) {
    Material m;
    m.metallic = 0;
    m.roughness = roughness;
    m.ior = ior;
    m.transmission = 1;
    m.thickness = 1;
    return m;
}

// ---- 39

void expectUnitRadiance(const gpu::Device& device, const Shot& shot) {
    const auto mean = [&](int lights, float emission) {
        Scene scene;
        addMesh(scene, turnedInwards(sphereMesh(64)), matte(glm::vec3(0.5f), glm::vec3(emission)));
        PunctualLight lamp;
        lamp.color = glm::vec3(static_cast<float>(pi / lights));
        if (emission == 0) scene.lights.assign(static_cast<size_t>(lights), lamp);
        return meanOf(render(device, scene, cameraAt({0.2, 0.1, 0.3}, {0.3, 0.2, -1}, 1.0), shot));
    };
    for (const auto& [lights, emission] : {std::pair(1, 0.0f), {4, 0.0f}, {1, 0.5f}}) {
        const Mean m = mean(lights, emission);
        recordWorst("off", std::abs(m.value - 1));
        EXPECT_NEAR(m.value, 1, 0.005) << lights << " lights, emission " << emission << ", sigma " << m.sigma;
    }
}

TEST_F(HardPath, HardCase39_InsideAUnitSphere) {
    expectUnitRadiance(device, {.size = 16, .samples = 32, .maxBounces = 64});
}
TEST_F(HardPath, FullHardCase39_InsideAUnitSphere) {
    expectUnitRadiance(device, {.size = 32, .samples = 512, .maxBounces = 64});
}

// ---- 40

TEST_F(HardPath, HardCase40_RussianRoulette) {
    Scene box;
    addMesh(box, cubeMesh(true), matte(glm::vec3(0.8f), glm::vec3(0.2f)));
    const Camera inside = cameraAt({0, 0, 0}, {0.3, 0.2, -1}, 1.2);
    for (uint32_t start = 1; start <= 8; start += 2)
        expectMean(meanOf(render(device, box, inside,
                                 {.size = 12, .samples = 64, .maxBounces = 300, .rouletteStart = start})),
                   1, 1e-5);
    expectMean(meanOf(render(device, box, inside,
                             {.size = 12, .samples = 64, .maxBounces = 120, .rouletteStart = 1000})),
               1, 1e-5);

    // Glass: throughput rises by 1/η² on the way in, which must not steer the roulette.
    Scene ball;
    addMesh(ball, sphereMesh(32), glass(1.5f, 0.3f));
    ball.environment = uniformEnvironment(glm::vec3(1));
    Mean first;
    for (const uint32_t start : {1u, 4u, 1000u}) {
        const Mean m = meanOf(render(device, ball, cameraAt({0, 0, 4}, {0, 0, 0}, 0.3),
                                     {.size = 16, .samples = 64, .maxBounces = 100, .rouletteStart = start}),
                              0, hit);
        if (start == 1)
            first = m;
        else
            expectSameMean(m, first);
    }
}

TEST_F(HardPath, FullHardCase40_EveryStartOfRoulette) {
    Scene box;
    addMesh(box, cubeMesh(true), matte(glm::vec3(0.8f), glm::vec3(0.2f)));
    Scene ball;
    addMesh(ball, sphereMesh(32), glass(1.5f, 0.3f));
    ball.environment = uniformEnvironment(glm::vec3(1));
    const Camera inBox = cameraAt({0, 0, 0}, {0.3, 0.2, -1}, 1.2),
                 outside = cameraAt({0, 0, 4}, {0, 0, 0}, 0.3),
                 inGlass = cameraAt({0.2, 0.1, 0.3}, {0.3, 0.2, -1}, 1.0);
    const Shot shot{.size = 32, .samples = 256, .maxBounces = 300, .rouletteStart = 1000};
    const Mean plainOutside = meanOf(render(device, ball, outside, shot), 0, hit),
               plainInside = meanOf(render(device, ball, inGlass, shot));
    for (uint32_t start = 1; start <= 8; ++start) {
        SCOPED_TRACE(start);
        Shot roulette = shot;
        roulette.rouletteStart = start;
        roulette.seed = 1 + start;
        expectMean(meanOf(render(device, box, inBox, roulette)), 1, 1e-5);
        expectSameMean(meanOf(render(device, ball, outside, roulette), 0, hit), plainOutside);
        expectSameMean(meanOf(render(device, ball, inGlass, roulette)), plainInside);
    }
}

Mean furnace99(const gpu::Device& device, const Shot& shot) {
    Scene box;
    addMesh(box, cubeMesh(true), matte(glm::vec3(0.99f), glm::vec3(1)));
    return meanOf(render(device, box, cameraAt({0, 0, 0}, {0.3, 0.2, -1}, 1.2), shot));
}

// 1 / (1 − ρ) = 100 to 1 %. A path's brightness is the number of its bounces, whose deviation is 100 with
// roulette from the start and 7 with roulette from bounce 600 on.
TEST_F(HardPath, HardCase40_FurnaceOfAlbedo99) {
    const Mean late =
        furnace99(device, {.size = 12, .samples = 16, .maxBounces = 3000, .rouletteStart = 600});
    EXPECT_NEAR(late.value, 100, 1);
    EXPECT_LT(late.sigma, 0.25);
    // Survival is the throughput itself: with a cap below 1 (there was one of 0.95) the weights of long paths
    // grow faster than the paths become rare, and their variance Σ (0.99² / 0.95)^k is infinite.
    const Mean early = furnace99(device, {.size = 12, .samples = 16, .maxBounces = 3000});
    expectMean(early, 100);
    EXPECT_NEAR(early.sigma, 100 / std::sqrt(12 * 12 * 16), 0.2)
        << "the deviation of a geometric distribution";
}
TEST_F(HardPath, FullHardCase40_FurnaceOfAlbedo99) {
    const Mean m = furnace99(device, {.size = 64, .samples = 64, .maxBounces = 4000});
    EXPECT_NEAR(m.value, 100, 1);
    EXPECT_LT(m.sigma, 0.25);
}

// ---- 26

TEST_F(HardPath, HardCase26_IndexOfRefractionNearOne) {
    Scene open;
    open.environment = uniformEnvironment(glm::vec3(0), 16, 8);
    for (uint32_t y = 0; y < 8; ++y)
        for (uint32_t x = 0; x < 16; ++x)
            for (uint32_t c = 0; c < 3; ++c)
                open.environment.image.rgbaFloat[4 * (y * 16 + x) + c] = static_cast<float>(
                    0.5 + 0.05 * std::cos(2 * pi * x / 16 + c) * std::sin(pi * (y + 0.5) / 8));
    open.materials.emplace_back();
    const Camera camera = cameraAt({0, 0, 4}, {0, 0, 0}, 0.5);
    const Shot shot{.size = 32, .samples = 8, .maxBounces = 8};
    const Picture without = render(device, open, camera, shot);
    for (const float ior : {1.0f, 1 + 1e-6f, 1 - 1e-6f, 1 + 1e-4f, 1 - 1e-4f}) {
        Scene scene = open;
        addMesh(scene, sphereMesh(48), glass(ior));
        const Picture with = render(device, scene, camera, shot);
        EXPECT_LE(furthestPixel(with, without), 1e-3) << "ior " << ior;
        EXPECT_EQ(with.stats.droppedSamples, 0u);
    }
}

// ---- 31

TEST_F(HardPath, HardCase31_CameraInsideGlass) {
    // From the middle of a ball every ray leaves at once, and radiance in glass is η² of that outside.
    Scene scene;
    addMesh(scene, sphereMesh(48), glass(1.5f));
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Mean m = meanOf(render(device, scene, cameraAt({0, 0, 0}, {0.2, 0.1, -1}, 1.0),
                                 {.size = 16, .samples = 64, .maxBounces = 32}));
    recordWorst("relative", std::abs(m.value / 2.25 - 1));
    EXPECT_NEAR(m.value, 2.25, 0.0225) << "sigma " << m.sigma;
}

// A solid that absorbs, without a surface to be seen where its index is 1.
Material coloured(const glm::vec3& color, float ior = 1) {
    Material m = glass(ior);
    m.attenuationColor = color;  // at one metre
    m.attenuationDistance = 1;
    return m;
}

void addBox(Scene& scene, const glm::dvec3& half, const Material& material) {
    addMesh(scene, cubeMesh(false), material, glm::scale(glm::dmat4(1), half));
}

void addBall(Scene& scene, double radius, const Material& material) {
    Shape ball;
    ball.size = glm::dvec3(radius);
    ball.material = static_cast<uint32_t>(scene.materials.size());
    scene.materials.push_back(material);
    scene.shapes.push_back(ball);
}

const glm::vec3 kBlockColor{0.5f, 0.25f, 1}, kBallColor{0.8f, 1, 0.3f};

/// Light of 1 from everywhere, seen straight along −z.
void expectAlongZ(const gpu::Device& device, Scene& scene, double z, const glm::dvec3& expected) {
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Picture picture = render(device, scene, cameraAt({0, 0, z}, {0, 0, z - 1}, 1e-4),
                                   {.size = 8, .samples = 8, .maxBounces = 16, .rouletteStart = 16});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(meanOf(picture, c).value, expected[c], 1e-5) << "from z " << z;
}

TEST_F(HardPath, HardCase31_SolidWithinASolidEachAbsorbs) {
    const glm::dvec3 block(kBlockColor), ball(kBallColor);
    Scene scene;
    addBox(scene, {10, 10, 1}, coloured(kBlockColor));
    addBall(scene, 0.5, coloured(kBallColor));
    expectAlongZ(device, scene, 5, block * ball);                                 // 1 m of each
    expectAlongZ(device, scene, 0.75, glm::pow(block, glm::dvec3(0.75)) * ball);  // from within the block
    expectAlongZ(device, scene, 0, glm::pow(block, glm::dvec3(0.5)) * glm::pow(ball, glm::dvec3(0.5)));
    expectAlongZ(device, scene, -0.75, glm::pow(block, glm::dvec3(0.25)));
}

// Of layers, each with what it reflects in front and behind and lets through, seen at a right angle (adding).
struct Layer {
    double front, back, through;
};
Layer operator+(const Layer& a, const Layer& b) {
    const double series = 1 / (1 - a.back * b.front);
    return {a.front + a.through * a.through * b.front * series,
            b.back + b.through * b.through * a.back * series, a.through * b.through * series};
}
Layer surface(double eta) {
    const double f = std::pow((eta - 1) / (eta + 1), 2);
    return {f, f, 1 - f};
}
Layer absorber(double color, double metres) {
    return {0, 0, std::pow(color, metres)};
}

TEST_F(HardPath, HardCase31_IndicesOfNestedSolidsAreRelative) {
    for (const float inner : {1.5f, 1.0f, 2.4f}) {
        Scene scene;
        addBox(scene, {10, 10, 1}, coloured(kBlockColor, 1.5f));
        addBox(scene, {5, 5, 0.5}, coloured(kBallColor, inner));
        addMesh(scene, quadMesh({-9, -9, -3}, {18, 0, 0}, {0, 18, 0}), matte(glm::vec3(0), glm::vec3(1)));
        scene.environment = uniformEnvironment(glm::vec3(0));
        const Picture picture = render(device, scene, cameraAt({0, 0, 5}, {0, 0, 0}, 1e-4),
                                       {.size = 32, .samples = 64, .maxBounces = 64});
        EXPECT_EQ(picture.stats.droppedSamples, 0u);
        for (int c = 0; c < 3; ++c) {
            const Layer half = absorber(double{kBlockColor[c]}, 0.5), face = surface(double{inner} / 1.5);
            const Layer all =
                surface(1.5) + half + face + absorber(double{kBallColor[c]}, 1) + face + half + surface(1.5);
            expectMean(meanOf(picture, c), all.through, 1e-5);
        }
    }
}

TEST_F(HardPath, HardCase31_MoreSolidsThanTheStackHoldsAreCounted) {
    Scene scene;
    for (int i = 0; i < 7; ++i) addBox(scene, glm::dvec3(8 - i), coloured(glm::vec3(0.9f)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Picture picture = render(device, scene, cameraAt({0, 0, 20}, {0, 0, 0}, 1e-4),
                                   {.size = 8, .samples = 2, .maxBounces = 32, .rouletteStart = 32});
    EXPECT_TRUE(allFinite(picture));
    EXPECT_EQ(picture.stats.faults.rejectedPaths, 8u * 8 * 2);
}

void expectVeils(const gpu::Device& device, int layers, uint32_t samples) {
    Material veil = matte(glm::vec3(0.25f));
    veil.unlit = true;
    veil.alphaMode = AlphaMode::blend;
    veil.alpha = static_cast<float>(1.0 / layers);
    Scene scene;
    Mesh stack;
    for (int i = 0; i < layers; ++i) {
        const Mesh quad = quadMesh({-5, -5, -0.01f * static_cast<float>(i)}, {10, 0, 0}, {0, 10, 0});
        const auto first = static_cast<uint32_t>(stack.positions.size());
        stack.positions.insert(stack.positions.end(), quad.positions.begin(), quad.positions.end());
        for (const glm::uvec3& t : quad.triangles) stack.triangles.push_back(t + first);
    }
    addMesh(scene, stack, veil);
    scene.environment = uniformEnvironment(glm::vec3(1));
    const double through = std::pow(1 - 1.0 / layers, layers), expected = through + 0.25 * (1 - through);
    const Mean m = meanOf(render(device, scene, cameraAt({0, 0, 5}, {0, 0, 0}, 0.1),
                                 {.size = 16, .samples = samples, .maxBounces = 2}));
    EXPECT_NEAR(m.value, expected, 0.01 * expected) << layers << " layers, sigma " << m.sigma;
    expectMean(m, expected);
}

TEST_F(HardPath, HardCase31_ThousandBlendedLayers) {
    expectVeils(device, 1000, 128);
}
TEST_F(HardPath, FullHardCase31_ThousandBlendedLayers) {
    for (const int layers : {1, 10, 100, 1000}) expectVeils(device, layers, 4096);
}

// ---- 46

TEST_F(HardPath, HardCase46_AlphaAndTextures) {
    Material veil = matte(glm::vec3(0));
    veil.unlit = true;
    Scene scene;
    addMesh(scene, quadMesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), veil);
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Camera camera = cameraAt({0, 0, 5}, {0, 0, 0}, 0.1);
    const auto value = [&](AlphaMode mode, float alpha, float cutoff) {
        scene.materials[0].alphaMode = mode;
        scene.materials[0].alpha = alpha;
        scene.materials[0].alphaCutoff = cutoff;
        return meanOf(render(device, scene, camera, {.size = 16, .samples = 4, .maxBounces = 1})).value;
    };
    EXPECT_EQ(value(AlphaMode::mask, 0.25f, 0.25f), 0) << "at the cutoff: visible";
    EXPECT_EQ(value(AlphaMode::mask, std::nextafter(0.25f, 0.0f), 0.25f), 1);
    EXPECT_EQ(value(AlphaMode::blend, 0, 0), 1) << "alpha 0 is never met";
    EXPECT_EQ(value(AlphaMode::blend, 1, 0), 0) << "alpha 1 always";

    // Decoded before it is filtered: halfway from red to green is half of each in linear light.
    Scene wall;
    Material picture;
    picture.unlit = true;
    picture.baseColorTexture.image = 0;
    picture.baseColorTexture.srgb = true;
    wall.images.push_back({"edge", 2, 1, {255, 0, 0, 255, 0, 255, 0, 255}, {}});
    addMesh(wall, quadMesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), picture);
    const auto colourAt = [&](double x) {
        const Picture seen = render(device, wall, cameraAt({x, 0, 5}, {x, 0, 0}, 1e-5),
                                    {.size = 8, .samples = 1, .maxBounces = 1});
        return glm::dvec2(meanOf(seen, 0).value, meanOf(seen, 1).value);
    };
    const auto expectColour = [&](double x, double red, const char* what) {
        const glm::dvec2 colour = colourAt(x);
        recordWorst("colour", std::abs(colour.x - red));
        EXPECT_NEAR(colour.x, red, 1e-3) << what;
        EXPECT_NEAR(colour.y, 1 - red, 1e-3) << what;
    };
    expectColour(0, 0.5, "edge");
    expectColour(-0.5, 1, "left texel");
    wall.materials[0].baseColorTexture.transform = {1, 0, 0, 1, 0.5f, 0};
    expectColour(-0.5, 0, "moved by half of the image");
    wall.materials[0].baseColorTexture.transform = {-1, 0, 0, 1, 1, 0};
    expectColour(-0.5, 0, "turned round");
    wall.materials[0].baseColorTexture.transform = {1, 0, 0, 1, 0, 0};
    wall.materials[0].baseColorTexture.uvSet = 1;
    wall.meshes[0].uv1.assign(4, {0.75f, 0.5f});
    expectColour(-0.5, 0, "second set of coordinates");
}

// ---- 6

Scene wrappedBall(float ior) {
    Scene scene;
    scene.materials = {matte({1, 0, 0}), glass(ior)};
    scene.materials[0].unlit = true;
    for (uint32_t i = 0; i < 2; ++i) {
        Shape ball;
        ball.size = glm::dvec3(i == 0 ? 1 : 1 + 4e-5);
        ball.material = i;
        scene.shapes.push_back(ball);
    }
    scene.environment = uniformEnvironment({0, 0, 1});
    return scene;
}

void expectNoLeak(const gpu::Device& device, const Shot& shot) {
    const Camera camera = cameraAt({1, 2, 3.5}, {0, 0, 0}, 0.3);
    // An index of 1 lets every ray straight in: blue is what got past the ball within.
    const Picture straight = render(device, wrappedBall(1), camera, shot);
    const double leak = meanOf(straight, 2).value;
    recordWorst("leak", leak);
    EXPECT_LE(leak, 1e-4);
    EXPECT_NEAR(meanOf(straight, 0).value, 1, 1e-4);
    const Picture bent = render(device, wrappedBall(1.5f), camera, shot);
    // What shines within the glass leaves it by 1 / 1.5² as bright, less what the interface reflects.
    for (const FilmPixel& pixel : bent.pixels)
        ASSERT_GT(pixel.mean[0], 0.3) << "the inner colour in every pixel";
    EXPECT_EQ(straight.stats.droppedSamples + bent.stats.droppedSamples, 0u);
}

TEST_F(HardPath, HardCase06_ThinGap) {
    expectNoLeak(device, {.size = 24, .samples = 64, .maxBounces = 16});
}
TEST_F(HardPath, FullHardCase06_ThinGap) {
    expectNoLeak(device, {.size = 128, .samples = 256, .maxBounces = 64});
}

// ---- 47

TEST_F(HardPath, HardCase47_ExtremeCameras) {
    Scene scene;
    addMesh(scene, sphereMesh(16), matte(glm::vec3(0.8f)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    for (const double degrees : {0.05, 179.0})
        for (const bool orthographic : {false, true}) {
            Camera camera = cameraAt({0, 0, 3}, {0, 0, 0}, glm::radians(degrees));
            camera.orthographic = orthographic;
            const Picture picture = render(device, scene, camera, {.size = 16, .samples = 16});
            EXPECT_TRUE(allFinite(picture));
            EXPECT_EQ(picture.stats.droppedSamples, 0u);
            EXPECT_EQ(blackPixels(picture), 0u);
            // The middle of the ball: white but for what its mesh loses (case 49).
            if (degrees < 1 && !orthographic) expectMean(meanOf(picture), 0.8, 1e-3);
        }
}

// ---- 48

TEST_F(HardPath, HardCase48_NothingToSee) {
    const Camera camera = cameraAt({0, 0, 5}, {0, 0, 0}, 0.5);
    const auto value = [&](const Scene& scene) {
        const Picture picture = render(device, scene, camera, {.size = 8, .samples = 2});
        EXPECT_TRUE(allFinite(picture));
        EXPECT_EQ(picture.stats.droppedSamples, 0u);
        return meanOf(picture).value;
    };
    Scene empty;
    empty.materials.emplace_back();
    EXPECT_EQ(value(empty), 0);
    Scene sky = empty;
    sky.environment = uniformEnvironment(glm::vec3(0.25f));
    EXPECT_EQ(value(sky), 0.25);
    Scene unlit;
    addMesh(unlit, cubeMesh(false), matte(glm::vec3(0.5f)));
    EXPECT_EQ(value(unlit), 0);
    Scene noTriangles;
    addMesh(noTriangles, Mesh{}, matte(glm::vec3(0.5f)));
    EXPECT_EQ(value(noTriangles), 0);
    Scene huge;
    Mesh wall;
    wall.positions = {{-1e9f, -1e9f, 0}, {1e9f, -1e9f, 0}, {0, 1e9f, 0}};
    wall.triangles = {{0, 1, 2}};
    addMesh(huge, wall, matte(glm::vec3(0.5f)));
    huge.environment = uniformEnvironment(glm::vec3(1));
    EXPECT_NEAR(value(huge), 0.5, 0.05) << "one triangle of 1e9";
}

// ---- 54

/// Two mirrors of reflectance R that glow with radiance 1 and face each other, and a camera between them.
Scene mirrors(float reflectance) {
    Material m;
    m.baseColor = glm::vec3(reflectance);
    m.roughness = 0;
    m.emission = glm::vec3(1);
    Scene scene;
    addMesh(scene, quadMesh({-1000, -1000, -1}, {2000, 0, 0}, {0, 2000, 0}), m);
    addMesh(scene, quadMesh({-1000, -1000, 1}, {0, 2000, 0}, {2000, 0, 0}), m);
    return scene;
}

TEST_F(HardPath, HardCase54_MirrorFacingMirror) {
    const float reflectance = 0.97f;
    const Scene scene = mirrors(reflectance);
    const Camera between = cameraAt({0, 0, 0}, {0, 0, -1}, 1e-4);
    const auto brightness = [&](uint32_t depth, uint32_t roulette) {
        const Picture picture =
            render(device, scene, between,
                   {.size = 8, .samples = 4, .maxBounces = depth, .rouletteStart = roulette});
        EXPECT_EQ(blackPixels(picture), 0u);
        EXPECT_EQ(picture.stats.droppedSamples, 0u);
        return meanOf(picture);
    };
    for (const uint32_t depth : {4u, 10u, 25u, 100u}) {
        const double bounce = brightness(depth, 10000).value - brightness(depth - 1, 10000).value;
        recordWorst("bounce", std::abs(bounce - std::pow(double{reflectance}, depth)));
        EXPECT_NEAR(bounce, std::pow(double{reflectance}, depth), 1e-4) << "bounce " << depth;
    }
    // Roulette instead of a limit: nothing black, the same sum.
    expectMean(brightness(5000, 4), 1 / (1 - double{reflectance}), 1e-3);
    EXPECT_GT(brightness(5000, 1).value, 1);
}

}  // namespace
}  // namespace tilefarm
