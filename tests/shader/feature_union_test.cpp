// A material looks the same whatever else stands in the scene: what kernels hold is the union of what
// materials call for, and every union is enough for each of them. One scene of cells shows it: in each cell,
// between black walls, a sphere that no light of another cell reaches; cells that are not looked at are
// black, so that all pictures share their geometry.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <set>

#include "shaders/gpu_types.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/render_frame.h"
#include "tests/support/test_scenes.h"
#include "worker/render/features.h"
#include "worker/render/material_packer.h"
#include "worker/render/renderer.h"

namespace tilefarm {
namespace {

struct NamedMaterial {
    std::string name;
    Material material;
};

Material plastic(float roughness) {
    Material m = matte({0.8f, 0.5f, 0.3f});
    m.ior = 1.5f;
    m.roughness = roughness;
    return m;
}

Material metal(float roughness) {
    Material m = plastic(roughness);
    m.metallic = 1;
    return m;
}

Material glass(float roughness, float thickness) {
    Material m = plastic(roughness);
    m.transmission = 1;
    m.thickness = thickness;
    return m;
}

std::vector<NamedMaterial> materials() {
    std::vector<NamedMaterial> list;
    const auto add = [&](const char* name, Material m, const std::function<void(Material&)>& change = {}) {
        if (change) change(m);
        list.push_back({name, m});
    };
    add("matte", matte({0.8f, 0.5f, 0.3f}));
    add("no specular", plastic(0.4f), [](Material& m) { m.specular = 0; });
    add("no specular, ideal index", plastic(0.4f), [](Material& m) { m.specular = 0, m.ior = 0; });
    add("tinted without index", matte(glm::vec3(0.7f)), [](Material& m) { m.specularColor = {1, 0, 0}; });
    add("coat without specular", plastic(0.4f), [](Material& m) { m.specular = 0, m.clearcoat = 0.7f; });
    add("plastic", plastic(0.5f));
    add("smooth plastic", plastic(0));
    add("tinted plastic", plastic(0.3f), [](Material& m) { m.specularColor = {0.2f, 1, 0.4f}; });
    add("metal", metal(0.4f));
    add("mirror", metal(0));
    add("metal of the ideal index", metal(0.4f), [](Material& m) { m.ior = 0, m.specularColor = {1, 0, 1}; });
    add("gold", metal(0.3f), [](Material& m) {
        m.conductor = true, m.conductorEta = {0.15f, 0.4f, 1.4f}, m.conductorK = {3.5f, 2.4f, 1.8f};
    });
    add("dielectric with a metal's index", plastic(0.3f), [](Material& m) { m.conductor = true; });
    add("brushed metal", metal(0.3f), [](Material& m) { m.anisotropy = 0.7f; });
    add("pane", glass(0, 0));
    add("rough glass", glass(0.4f, 1), [](Material& m) {
        m.attenuationColor = {0.4f, 0.8f, 0.9f}, m.attenuationDistance = 1;
    });
    add("glass dispersed to air", glass(0.3f, 1), [](Material& m) { m.dispersion = 45; });
    add("sheen", matte(glm::vec3(0.3f)),
        [](Material& m) { m.sheenColor = glm::vec3(0.6f), m.sheenRoughness = 0.4f; });
    add("metal with a cloth's sheen", metal(0.5f), [](Material& m) { m.disneySheen = 1; });
    add("leaf", matte(glm::vec3(0.5f)), [](Material& m) { m.diffuseTransmission = 0.5f; });
    add("coated metal that says it lets light through", metal(0.5f),
        [](Material& m) { m.diffuseTransmission = 0.5f, m.thickness = 1, m.clearcoat = 1; });
    add("clay", matte(glm::vec3(0.6f)), [](Material& m) { m.orenNayarSigma = 0.5f; });
    add("skin", matte(glm::vec3(0.6f)),
        [](Material& m) { m.disneyDiffuse = true, m.subsurface = 0.5f, m.orenNayarSigma = 1; });
    add("bubble", plastic(0.2f), [](Material& m) { m.iridescence = 1; });
    add("Schlick metal", metal(0.5f), [](Material& m) { m.fresnel = Fresnel::schlick; });
    add("Beckmann", plastic(0.4f), [](Material& m) { m.microfacets = Microfacets::beckmann; });
    add("Phong", plastic(0.4f), [](Material& m) { m.microfacets = Microfacets::phong; });
    add("veil", matte(glm::vec3(0.6f)), [](Material& m) { m.alphaMode = AlphaMode::blend, m.alpha = 0.6f; });
    add("label", matte({0.2f, 0.4f, 0.6f}), [](Material& m) { m.unlit = true; });
    return list;
}

uint64_t featuresOf(const Material& material) {
    const Scene scene;
    TexturePacker textures(scene);
    MaterialPacker packer(textures);
    packer.add(material, true);
    return packer.features;
}

constexpr uint32_t kColumns = 6, kCell = 12;

uint32_t rowsFor(size_t cells) {
    return static_cast<uint32_t>((cells + kColumns - 1) / kColumns);
}

/// A cube without its front, its walls inside.
Mesh openBox() {
    Mesh box = cubeMesh(true);
    std::erase_if(box.triangles, [&](const glm::uvec3& t) {
        return box.positions[t.x].z > 0 && box.positions[t.y].z > 0 && box.positions[t.z].z > 0;
    });
    return box;
}

class FeatureUnionTest : public DeviceTest {
protected:
    const std::vector<NamedMaterial> list = materials();

    /// The cells whose materials call for nothing beyond `features` have them, the others are black.
    Scene cellsWithin(uint64_t features) const {
        Scene scene;
        for (size_t i = 0; i < list.size(); ++i) {
            const glm::dvec3 at(2 * double(i % kColumns), 2 * double(i / kColumns), 0);
            const glm::dmat4 placed = glm::translate(glm::dmat4(1), at);
            const bool shown = (featuresOf(list[i].material) & ~features) == 0;
            addMesh(scene, openBox(), matte(glm::vec3(0)), placed);
            addMesh(scene, sphereMesh(6), shown ? list[i].material : matte(glm::vec3(0)),
                    glm::scale(placed, glm::dvec3(0.8)));
        }
        scene.environment = uniformEnvironment({0.5f, 0.8f, 1});
        return scene;
    }

    struct Cells {
        std::vector<PassPixel> pixels;
        uint64_t features = 0;
    };

    Cells render(uint64_t within, uint64_t forcedFeatures = 0) {
        const uint32_t rows = rowsFor(list.size());
        ImageSpec image;
        image.width = kColumns * kCell;
        image.height = rows * kCell;
        Camera camera = cameraAt({kColumns - 1., rows - 1., 5}, {kColumns - 1., rows - 1., 0}, 0.5);
        camera.orthographic = true;
        camera.xmag = kColumns;
        camera.ymag = static_cast<float>(rows);
        RenderSettings settings;
        settings.maxBounces = 4;
        settings.culling = Culling::none;
        Renderer renderer(device, cellsWithin(within), camera, image, settings, {}, forcedFeatures);
        return {renderer.render(0, std::vector<uint32_t>{0}, {0, 4}).front().pixels, renderer.featureBits()};
    }

    void expectSameCells(const Cells& a, const Cells& b, uint64_t within, const std::string& kernel) {
        const uint32_t rows = rowsFor(list.size()), width = kColumns * kCell;
        for (size_t i = 0; i < list.size(); ++i) {
            if ((featuresOf(list[i].material) & ~within) != 0) continue;
            size_t other = 0;
            const size_t top = (rows - 1 - i / kColumns) * kCell, left = i % kColumns * kCell;
            for (size_t y = top; y < top + kCell; ++y)
                for (size_t x = left; x < left + kCell; ++x)
                    other += std::memcmp(&a.pixels[y * width + x], &b.pixels[y * width + x],
                                         sizeof(PassPixel)) != 0;
            EXPECT_EQ(other, 0u) << "pixels of " << list[i].name << " that changed in " << kernel;
        }
    }

    /// What the pairs of the list call for, those that call for least first: they leave out most.
    std::vector<uint64_t> unionsOfPairs() const {
        std::set<uint64_t> unions;
        for (const NamedMaterial& a : list)
            for (const NamedMaterial& b : list)
                unions.insert(featuresOf(a.material) | featuresOf(b.material));
        std::vector<uint64_t> sorted(unions.begin(), unions.end());
        std::stable_sort(sorted.begin(), sorted.end(),
                         [](uint64_t a, uint64_t b) { return std::popcount(a) < std::popcount(b); });
        return sorted;
    }

    void expectUnionsEnough(size_t most) {
        constexpr uint64_t kAll = ~uint64_t{0} >> (64 - gpu::FEATURE_COUNT);
        const Cells reference = render(kAll);
        expectSameCells(reference, render(kAll, kAll), kAll, "the kernel of all bits");
        const std::vector<uint64_t> unions = unionsOfPairs();
        for (size_t i = 0; i < std::min(most, unions.size()); ++i) {
            std::string names;
            for (uint32_t bit = 0; bit < gpu::FEATURE_COUNT; ++bit)
                if ((unions[i] >> bit & 1u) != 0) names += std::string(featureName(bit)) + ", ";
            expectSameCells(reference, render(unions[i]), unions[i], "the kernel of " + names);
        }
    }
};

TEST_F(FeatureUnionTest, FullSmallUnionsAreEnoughForEachMaterial) {
    expectUnionsEnough(16);
}

TEST_F(FeatureUnionTest, FullUnionsOfAllPairsAreEnoughForEachMaterial) {
    expectUnionsEnough(1u << 20);
}

TEST_F(FeatureUnionTest, ADiffuseSphereWithoutSpecularStaysSoBesideAMetal) {
    // In a white furnace it shows its albedo.
    Scene scene;
    Material m = plastic(0.4f);
    m.baseColor = glm::vec3(0.8f);
    m.specular = 0;
    addMesh(scene, sphereMesh(12), m);
    addMesh(scene, quadMesh({0, 0, 90}, {0.1f, 0, 0}, {0, 0.1f, 0}), metal(0.5f));
    scene.environment = uniformEnvironment(glm::vec3(1));
    expectMean(
        meanOf(renderFrame(device, scene, cameraAt({0, 0, 5}, {0, 0, 0}, 0.1), square(16), bounces(4), 64)),
        0.8);
}

TEST_F(FeatureUnionTest, AMatteSphereInWaterGainsNoLight) {
    // Water in a white furnace returns all light; what lies in it reflected more than arrived, since its
    // index of 1 was taken relative to the water's.
    Scene scene;
    Material water = matte(glm::vec3(1));
    water.ior = 1.33f;
    water.roughness = 0;
    water.transmission = 1;
    water.thickness = 1;
    addMesh(scene, cubeMesh(false), water, glm::scale(glm::dmat4(1), glm::dvec3(2)));
    Material pebble = matte(glm::vec3(1));
    pebble.roughness = 0.5f;
    addMesh(scene, sphereMesh(8), pebble);
    scene.environment = uniformEnvironment(glm::vec3(1));
    RenderSettings settings = bounces(200);
    expectMean(
        meanOf(renderFrame(device, scene, cameraAt({0, 0, 6}, {0, 0, 0}, 0.1), square(8), settings, 64)), 1,
        2e-3);
}

}  // namespace
}  // namespace tilefarm
