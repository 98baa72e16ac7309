// Case 57: emitters that are cut out send out emission times alpha, however their light is found.
#include <cmath>
#include <filesystem>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <numeric>

#include "shared/job/job.h"
#include "tests/numerics/picture.h"
#include "tests/shader/device_fixture.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

constexpr float kRadiance = 5;
constexpr double kPitch = 10;

/// One emitter, 2 m above a floor of albedo 0.8 in a black closed room; rooms stand in a row.
struct Room {
    std::string name;
    std::function<void(Scene&, const glm::dmat4& place)> furnish;
    double floor = 0;  // radiance below the middle
};

Material emitter(AlphaMode mode, float alpha) {
    Material m = matte(glm::vec3(0), glm::vec3(kRadiance));
    m.alphaMode = mode;
    m.alpha = alpha;
    return m;
}

/// A metre wide, facing down.
Mesh panel(double height = 2) {
    return quadMesh({-0.5f, static_cast<float>(height), -0.5f}, {1, 0, 0}, {0, 0, 1});
}

double floorBelow(double left, double right) {
    const double e =
        kRadiance * polygonIrradiance({{left, 2, -0.5}, {right, 2, -0.5}, {right, 2, 0.5}, {left, 2, 0.5}},
                                      {0, 0, 0}, {0, 1, 0});
    return 0.8 / pi * e;
}

void addShape(Scene& scene, Shape shape, const Material& material, const glm::dmat4& toWorld) {
    shape.toWorld = toWorld;
    shape.material = static_cast<uint32_t>(scene.materials.size());
    scene.materials.push_back(material);
    scene.shapes.push_back(std::move(shape));
}

Room panelRoom(std::string name, const Material& material, double share) {
    return {std::move(name),
            [=](Scene& scene, const glm::dmat4& at) { addMesh(scene, panel(), material, at); },
            share * floorBelow(-0.5, 0.5)};
}

/// Images of the rooms: alpha 0 left and 255 right; alpha 128.
std::vector<Image> images() {
    return {{"halves", 2, 1, {255, 255, 255, 0, 255, 255, 255, 255}, {}},
            {"half", 1, 1, {255, 255, 255, 128}, {}}};
}

Room maskedHalf() {
    Material m = emitter(AlphaMode::mask, 1);
    m.baseColorTexture.image = 0;
    m.baseColorTexture.wrapS = m.baseColorTexture.wrapT = Wrap::clamp;
    Room room = panelRoom("masked half", m, 1);
    room.floor = floorBelow(0, 0.5);
    return room;
}

/// Alpha from 0 to 1 across: half of the light below the middle.
Room gradient() {
    return {"vertex colours",
            [](Scene& scene, const glm::dmat4& at) {
                Mesh mesh = panel();
                mesh.colors = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}};
                addMesh(scene, mesh, emitter(AlphaMode::blend, 1), at);
            },
            0.5 * floorBelow(-0.5, 0.5)};
}

Room texturedVeil() {
    Material m = emitter(AlphaMode::blend, 0.5f);
    m.baseColorTexture.image = 1;
    return panelRoom("textured veil", m, 0.5 * 128 / 255);
}

Room rectangle(AlphaMode mode, float alpha, double share) {
    return {"rectangle",
            [=](Scene& scene, const glm::dmat4& at) {
                Shape shape;
                shape.kind = ShapeKind::rectangle;
                shape.size = {0.5, 0.5, 1};
                const glm::dmat4 down = glm::rotate(glm::translate(at, {0., 2., 0.}), pi / 2, {1., 0., 0.});
                addShape(scene, shape, emitter(mode, alpha), down);
            },
            share * floorBelow(-0.5, 0.5)};
}

/// Its far side shines through the near one: α + (1 − α) α.
Room ball(float alpha) {
    return {"ball",
            [=](Scene& scene, const glm::dmat4& at) {
                Shape shape;
                shape.size = glm::dvec3(0.5);
                Material m = emitter(AlphaMode::blend, alpha);
                m.doubleSided = true;
                addShape(scene, shape, m, glm::translate(at, {0., 2., 0.}));
            },
            0.8 * kRadiance * 0.0625 * alpha * (2 - alpha)};
}

/// Seen and lit through a veil, which lets half of the light through either time.
Room behindAVeil() {
    return {"behind a veil",
            [](Scene& scene, const glm::dmat4& at) {
                addMesh(scene, panel(), emitter(AlphaMode::opaque, 1), at);
                Material veil = matte(glm::vec3(0));
                veil.alphaMode = AlphaMode::blend;
                veil.alpha = 0.5f;
                addMesh(scene, quadMesh({-2, 0.5f, -2}, {4, 0, 0}, {0, 0, 4}), veil, at);
            },
            0.25 * floorBelow(-0.5, 0.5)};
}

std::vector<Room> rooms() {
    return {panelRoom("opaque", emitter(AlphaMode::opaque, 0.3f), 1),
            panelRoom("veil of 0.5", emitter(AlphaMode::blend, 0.5f), 0.5),
            panelRoom("veil of 0.1", emitter(AlphaMode::blend, 0.1f), 0.1),
            panelRoom("veil of 0", emitter(AlphaMode::blend, 0), 0),
            panelRoom("masked away", emitter(AlphaMode::mask, 0.4f), 0),
            maskedHalf(),
            gradient(),
            texturedVeil(),
            rectangle(AlphaMode::blend, 0.6f, 0.6),
            rectangle(AlphaMode::mask, 0.3f, 0),
            ball(0.4f),
            behindAVeil()};
}

Scene rowOfRooms(const std::vector<Room>& rooms) {
    Scene scene;
    scene.images = images();
    for (size_t i = 0; i < rooms.size(); ++i) {
        const glm::dmat4 at = glm::translate(glm::dmat4(1), {kPitch * double(i), 0., 0.});
        addMesh(scene, cubeMesh(true), matte(glm::vec3(0)), glm::scale(at, glm::dvec3(3)));
        addMesh(scene, quadMesh({-0.01f, 0, 0.01f}, {0.02f, 0, 0}, {0, 0, -0.02f}), matte(glm::vec3(0.8f)),
                at);
        rooms[i].furnish(scene, at);
    }
    return scene;
}

/// Mean over the pixels of a square image, red.
Mean meanOf(const std::vector<PassFilm>& films) {
    FilmTile tile(films.front().rect);
    for (const PassFilm& film : films) tile.merge(film);
    Mean mean;
    for (const FilmPixel& pixel : tile.pixels) {
        mean.value += pixel.mean[0];
        mean.sigma += pixel.varianceOfMean(0);
    }
    const auto n = static_cast<double>(tile.pixels.size());
    return {mean.value / n, std::sqrt(mean.sigma) / n};
}

class HardAlphaEmitter : public DeviceTest {
protected:
    /// One kernel sees all rooms.
    void expectRooms(DirectLight directLight, LightSelection selection, uint32_t samples) {
        SCOPED_TRACE(static_cast<int>(directLight));
        SCOPED_TRACE(static_cast<int>(selection));
        const std::vector<Room> all = rooms();
        const Scene scene = rowOfRooms(all);
        const Shot shot{.size = 16, .maxBounces = 1, .directLight = directLight, .lightSelection = selection};
        Renderer renderer(device, scene, viewOf(0), imageOf(shot), settingsOf(shot));
        for (size_t i = 0; i < all.size(); ++i) {
            SCOPED_TRACE(all[i].name);
            renderer.setCamera({{viewOf(i)}, std::nullopt});
            std::vector<PassFilm> films;
            for (const SampleRange& range : passSchedule(samples))
                films.push_back(renderer.render(0, std::vector<uint32_t>{0}, range).front());
            expectMean(meanOf(films), all[i].floor, 1e-5);
        }
    }

    static Camera viewOf(size_t room) {
        const glm::dvec3 at(kPitch * double(room), 0, 0);
        return cameraAt(at + glm::dvec3(0, 1, 1e-3), at, 1e-4);
    }
};

TEST_F(HardAlphaEmitter, HardCase57_EmissionTimesAlpha) {
    expectRooms(DirectLight::mis, LightSelection::power, 256);
}

TEST_F(HardAlphaEmitter, HardCase57_ByLightsAlone) {
    expectRooms(DirectLight::lights, LightSelection::all, 128);
}

TEST_F(HardAlphaEmitter, HardCase57_ByTheBsdfAlone) {
    expectRooms(DirectLight::bsdf, LightSelection::power, 256);
}

TEST_F(HardAlphaEmitter, HardCase57_ByTheTree) {
    expectRooms(DirectLight::mis, LightSelection::tree, 256);
}

TEST_F(HardAlphaEmitter, FullHardCase57_EveryModeAndSelection) {
    for (const DirectLight mode : {DirectLight::mis, DirectLight::lights, DirectLight::bsdf})
        for (const LightSelection selection :
             {LightSelection::power, LightSelection::uniform, LightSelection::tree, LightSelection::all})
            expectRooms(mode, selection, 1024);
}

TEST_F(HardAlphaEmitter, HardCase57_SharedFiles) {
    const std::filesystem::path folder = "../shared/cases/emis-alpha-coverage";
    const auto root = std::filesystem::path(TILEFARM_SOURCE_DIR) / folder;
    if (!std::filesystem::exists(root)) GTEST_SKIP() << "needs " << folder;
    const std::vector<std::pair<const char*, double>> files{
        {"opaque", 1}, {"blend05", 0.5}, {"blend01", 0.1}, {"blend00", 0}, {"mask-half", 0.5}};
    for (const auto& [name, share] : files) {
        SCOPED_TRACE(name);
        const Scene scene = loadGltf(root / (std::string(name) + ".gltf"));
        for (const DirectLight mode : {DirectLight::mis, DirectLight::lights, DirectLight::bsdf}) {
            const Shot shot{.size = 16, .samples = 64, .maxBounces = 1, .directLight = mode};
            const Camera camera = cameraAt({0, 1, 1e-3}, {0, 0, 0}, 1e-4);
            expectMean(tilefarm::meanOf(render(device, scene, camera, shot)), 0.29391 * share, 2e-5);
        }
    }
}

}  // namespace
}  // namespace tilefarm
