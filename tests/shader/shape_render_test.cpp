// Shapes in pictures: each kind against a fine mesh of it, in glass, cut out and as what blocks light.
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/numerics/picture.h"
#include "tests/shader/device_fixture.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

class ShapePictures : public DeviceTest {};

// A grid over [0, 1]² with a point per vertex; u wraps round.
Mesh gridMesh(int columns, int rows, const std::function<glm::dvec3(double, double)>& point) {
    Mesh mesh;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const double u = double(i) / columns, v = double(j) / rows;
            mesh.positions.emplace_back(point(i == columns ? 0 : u, v));
            mesh.uv0.emplace_back(u, v);
        }
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto a = static_cast<uint32_t>(j * (columns + 1) + i), b = a + 1,
                       c = a + static_cast<uint32_t>(columns) + 1, d = c + 1;
            mesh.triangles.emplace_back(a, c, b);
            mesh.triangles.emplace_back(b, c, d);
        }
    return mesh;
}

// Round the y axis the way shapes count u: (radius, y) at v = 0 … 1 from the top.
Mesh turnedMesh(int columns, int rows, const std::function<glm::dvec2(double)>& profile) {
    return gridMesh(columns, rows, [&](double u, double v) {
        const glm::dvec2 p = profile(v);
        return glm::dvec3(-p.x * std::cos(2 * pi * u), p.y, p.x * std::sin(2 * pi * u));
    });
}

Material patterned(Scene& scene) {
    if (scene.images.empty()) {
        Image image{"pattern", 16, 8, {}, {}};
        for (uint32_t i = 0; i < 16 * 8; ++i)
            image.rgba8.insert(image.rgba8.end(), {static_cast<uint8_t>(60 + 37 * i % 180),
                                                   static_cast<uint8_t>(60 + 53 * i % 180), 120, 255});
        scene.images.push_back(image);
    }
    Material m;
    m.metallic = 0;
    m.roughness = 0.4f;
    m.baseColorTexture.image = 0;
    m.baseColorTexture.srgb = true;
    return m;
}

// A floor under a sky that is bright on one side.
Scene studio() {
    Scene scene;
    scene.environment = uniformEnvironment(glm::vec3(0.3f), 16, 8);
    for (int x = 2; x < 6; ++x)
        for (int y = 1; y < 3; ++y)
            for (int c = 0; c < 3; ++c) scene.environment.image.rgbaFloat[size_t(4 * (y * 16 + x) + c)] = 5;
    addMesh(scene, quadMesh({-8, -1.2f, 8}, {16, 0, 0}, {0, 0, -16}), matte(glm::vec3(0.6f)));
    return scene;
}

glm::dmat4 tilted() {
    return glm::rotate(glm::dmat4(1), 0.5, glm::normalize(glm::dvec3(1, 0.3, 0.2)));
}

Picture pictureOf(const gpu::Device& device, const Scene& scene, uint32_t seed) {
    return render(device, scene, cameraAt({0.4, 1.2, 4.2}, {0, -0.1, 0}, 0.75),
                  {.size = 30, .samples = 32, .seed = seed});
}

// Blocks of pixels compared by z-test: a wrong place, normal or texture shows in a block, noise does not.
void expectSamePicture(const Picture& a, const Picture& b, double slack) {
    constexpr uint32_t kBlock = 5;
    const auto blockOf = [&](const Picture& p, uint32_t bx, uint32_t by, int channel) {
        Mean mean;
        double variance = 0;
        for (uint32_t y = by; y < by + kBlock; ++y)
            for (uint32_t x = bx; x < bx + kBlock; ++x) {
                const FilmPixel& pixel = p.pixels[y * p.width + x];
                mean.value += pixel.mean[size_t(channel)] / (kBlock * kBlock);
                variance += pixel.varianceOfMean(channel);
            }
        mean.sigma = std::sqrt(variance) / (kBlock * kBlock);
        return mean;
    };
    for (uint32_t y = 0; y < a.width; y += kBlock)
        for (uint32_t x = 0; x < a.width; x += kBlock)
            for (int channel = 0; channel < 2; ++channel) {
                SCOPED_TRACE(testing::Message() << "block " << x << ", " << y);
                expectSameMean(blockOf(a, x, y, channel), blockOf(b, x, y, channel), slack);
            }
}

void compareWithMesh(const gpu::Device& device, Shape shape, Mesh mesh, double slack = 2e-3) {
    Scene analytic = studio(), meshed = studio();
    shape.toWorld = tilted() * shape.toWorld;
    addMesh(meshed, std::move(mesh), patterned(meshed), shape.toWorld);
    shape.material = static_cast<uint32_t>(analytic.materials.size());
    analytic.materials.push_back(patterned(analytic));
    analytic.shapes.push_back(shape);
    expectSamePicture(pictureOf(device, analytic, 1), pictureOf(device, meshed, 2), slack);
}

TEST_F(ShapePictures, SphereLooksLikeItsMesh) {
    compareWithMesh(device, shapeOf(ShapeKind::sphere, glm::dvec3(1)), turnedMesh(256, 128, [](double v) {
                        return glm::dvec2(v == 0 || v == 1 ? 0 : std::sin(pi * v), std::cos(pi * v));
                    }));
}

TEST_F(ShapePictures, FullEllipsoidLooksLikeItsMesh) {
    Shape shape = shapeOf(ShapeKind::sphere, glm::dvec3(1));
    shape.toWorld = glm::scale(glm::dmat4(1), glm::dvec3(1.1, 0.5, 0.8));
    compareWithMesh(device, shape, turnedMesh(256, 128, [](double v) {
                        return glm::dvec2(v == 0 || v == 1 ? 0 : std::sin(pi * v), std::cos(pi * v));
                    }));
}

TEST_F(ShapePictures, FullBoxLooksLikeItsMesh) {
    Mesh mesh;
    // Faces as seen from outside, v down: normal, right, up.
    const std::pair<glm::vec3, glm::vec3> faces[] = {{{1, 0, 0}, {0, 0, -1}}, {{-1, 0, 0}, {0, 0, 1}},
                                                     {{0, 1, 0}, {1, 0, 0}},  {{0, -1, 0}, {1, 0, 0}},
                                                     {{0, 0, 1}, {1, 0, 0}},  {{0, 0, -1}, {-1, 0, 0}}};
    const glm::vec3 size(0.9f, 0.6f, 0.7f);
    for (const auto& [normal, right] : faces) {
        const glm::vec3 up = glm::cross(normal, right);
        const auto first = static_cast<uint32_t>(mesh.positions.size());
        for (const glm::vec2 c : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
            mesh.positions.push_back(size * (normal + c.x * right + c.y * up));
            mesh.uv0.emplace_back(0.5f + 0.5f * c.x, 0.5f - 0.5f * c.y);
        }
        mesh.triangles.emplace_back(first, first + 1, first + 2);
        mesh.triangles.emplace_back(first, first + 2, first + 3);
    }
    compareWithMesh(device, shapeOf(ShapeKind::box, size), mesh);
}

TEST_F(ShapePictures, FullCylinderLooksLikeItsMesh) {
    // The side alone has the mesh's texture coordinates; the caps are looked at by their light.
    const glm::dvec3 size(0.8, 0.6, 0.4);
    Scene analytic = studio(), meshed = studio();
    Shape shape = shapeOf(ShapeKind::cylinder, size);
    shape.toWorld = tilted();
    analytic.shapes.push_back(shape);
    addMesh(meshed,
            turnedMesh(256, 3,
                       [&](double v) {
                           if (v == 0) return glm::dvec2(0, size.x);
                           if (v == 1) return glm::dvec2(0, -size.x);
                           return v < 0.5 ? glm::dvec2(size.z, size.x) : glm::dvec2(size.y, -size.x);
                       }),
            matte(glm::vec3(0.7f)), shape.toWorld);
    analytic.shapes[0].material = static_cast<uint32_t>(analytic.materials.size());
    analytic.materials.push_back(matte(glm::vec3(0.7f)));
    expectSamePicture(pictureOf(device, analytic, 1), pictureOf(device, meshed, 2), 2e-3);
}

TEST_F(ShapePictures, CapsuleLooksLikeItsMesh) {
    const glm::dvec3 size(0.5, 0.6, 0.3);  // half distance, radii below and above
    const double sine = (size.y - size.z) / (2 * size.x), lean = std::asin(sine);
    const double top = size.x + size.z, height = 2 * size.x + size.y + size.z;
    // Half the rows each to the arcs; v of the mesh by height, as the shape has it.
    Mesh mesh = turnedMesh(256, 401, [&](double v) {
        const double s = v * 2;
        if (v == 0) return glm::dvec2(0, top);
        if (v == 1) return glm::dvec2(0, -size.x - size.y);
        const bool upper = s < 1;
        const double angle = upper ? pi / 2 - s * (pi / 2 - lean) : lean - (s - 1) * (pi / 2 + lean);
        const double r = upper ? size.z : size.y;
        return glm::dvec2(r * std::cos(angle), (upper ? size.x : -size.x) + r * std::sin(angle));
    });
    for (size_t i = 0; i < mesh.uv0.size(); ++i)
        mesh.uv0[i].y = static_cast<float>((top - mesh.positions[i].y) / height);
    compareWithMesh(device, shapeOf(ShapeKind::capsule, size), mesh);
}

TEST_F(ShapePictures, FullTorusLooksLikeItsMesh) {
    Shape shape = shapeOf(ShapeKind::field, glm::dvec3(1));
    shape.field = {{FieldOperation::torus, {0.8, 0.3, 0, 0}, glm::dvec3(0), {0, 0, 0, 1}}};
    Scene analytic = studio(), meshed = studio();
    shape.toWorld = tilted();
    shape.material = static_cast<uint32_t>(analytic.materials.size());
    analytic.materials.push_back(matte({0.8f, 0.4f, 0.2f}));
    analytic.shapes.push_back(shape);
    addMesh(meshed,
            turnedMesh(256, 128,
                       [](double v) {
                           const double a = v == 1 ? 0 : 2 * pi * v;
                           return glm::dvec2(0.8 + 0.3 * std::cos(a), -0.3 * std::sin(a));
                       }),
            matte({0.8f, 0.4f, 0.2f}), shape.toWorld);
    expectSamePicture(pictureOf(device, analytic, 1), pictureOf(device, meshed, 2), 3e-3);
}

TEST_F(ShapePictures, GlassOfEveryKindIsInvisibleUnderUniformSky) {
    Material glass;
    glass.metallic = 0;
    glass.roughness = 0;
    glass.transmission = 1;
    glass.thickness = 1;
    Shape blend = shapeOf(ShapeKind::field, glm::dvec3(1));
    blend.field = {{FieldOperation::sphere, {0.6, 0, 0, 0}, {-0.3, 0, 0}, {0, 0, 0, 1}},
                   {FieldOperation::torus, {0.5, 0.2, 0, 0}, {0.3, 0, 0}, {0, 0, 0, 1}},
                   {FieldOperation::unite, {0.2, 0, 0, 0}, glm::dvec3(0), {0, 0, 0, 1}}};
    for (Shape shape : {shapeOf(ShapeKind::sphere, glm::dvec3(0.8)), shapeOf(ShapeKind::box, {0.6, 0.5, 0.4}),
                        shapeOf(ShapeKind::cylinder, {0.6, 0.5, 0.3}),
                        shapeOf(ShapeKind::capsule, {0.4, 0.4, 0.2}), blend}) {
        SCOPED_TRACE(nameOf(shape.kind));
        Scene scene;
        scene.materials.push_back(glass);
        scene.environment = uniformEnvironment(glm::vec3(1));
        shape.toWorld = tilted();
        scene.shapes.push_back(shape);
        const Picture picture = render(device, scene, cameraAt({0, 0, 4}, {0, 0, 0}, 0.4),
                                       {.size = 16, .samples = 16, .maxBounces = 100});
        EXPECT_TRUE(allFinite(picture));
        expectMean(meanOf(picture), 1, 2e-3);
    }
}

TEST_F(ShapePictures, CutOutShapesLetLightThroughToTheirOtherSideAndOn) {
    // Alpha 0.5 at each of two crossings: a quarter of the rays goes through.
    Material veil = matte(glm::vec3(0));
    veil.alphaMode = AlphaMode::blend;
    veil.alpha = 0.5f;
    Scene scene;
    scene.materials.push_back(veil);
    scene.shapes.push_back(shapeOf(ShapeKind::sphere, glm::dvec3(10)));
    scene.environment = uniformEnvironment(glm::vec3(1));
    const Camera camera = cameraAt({0, 0, 40}, {0, 0, 0}, 0.1);
    expectMean(meanOf(render(device, scene, camera, {.samples = 256})), 0.25, 1e-3);
    // And of the shadow rays to a light behind it.
    Scene lit;
    lit.materials.push_back(veil);
    lit.shapes = scene.shapes;
    addMesh(lit, quadMesh({-50, -12, 50}, {100, 0, 0}, {0, 0, -100}), matte(glm::vec3(1)));
    PunctualLight sun;
    sun.type = PunctualType::directional;
    sun.direction = {0, -1, 0};
    sun.color = glm::vec3(float(pi));
    lit.lights = {sun};
    const Camera below = cameraAt({0, -11, 14}, {0, -12, 0}, 0.02);
    expectMean(meanOf(render(device, lit, below, {.samples = 256, .maxBounces = 1})), 0.25, 1e-3);
}

// The same picture by sampling the rectangle's solid angle, by finding it, and from two emissive triangles;
// also mirrored, where its front stays its front.
TEST_F(ShapePictures, EmissiveRectanglesAreSampledByTheirSolidAngle) {
    for (const double side : {1.0, -1.0}) {
        Shape lamp = shapeOf(ShapeKind::rectangle, {1, 0.5, 0});
        lamp.toWorld = glm::translate(glm::dmat4(1), glm::dvec3(0.4, 1, 0)) *
                       glm::rotate(glm::dmat4(1), std::numbers::pi / 2, glm::dvec3(1, 0, 0)) *
                       glm::scale(glm::dmat4(1), glm::dvec3(side, 1, 1));
        Scene scene;
        addMesh(scene, quadMesh({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}), matte(glm::vec3(0.5f)));
        lamp.material = 1;
        scene.materials.push_back(matte(glm::vec3(0), glm::vec3(4)));
        scene.shapes.push_back(lamp);
        const Camera camera = cameraAt({0.7, 0.6, 0.2}, {0.7, 0, 0.2}, 1e-3);
        const double irradiance =
            4 * polygonIrradiance({{-0.6, 1, -0.5}, {1.4, 1, -0.5}, {1.4, 1, 0.5}, {-0.6, 1, 0.5}},
                                  {0.7, 0, 0.2}, {0, 1, 0});
        for (const DirectLight direct : {DirectLight::mis, DirectLight::lights, DirectLight::bsdf}) {
            if (side < 0 && direct != DirectLight::mis) continue;
            SCOPED_TRACE(static_cast<int>(direct));
            const Picture picture =
                render(device, scene, camera, {.samples = 64, .maxBounces = 1, .directLight = direct});
            expectMean(meanOf(picture), 0.5 / pi * irradiance, 1e-4);
        }
    }
}

}  // namespace
}  // namespace tilefarm
