// Expected counts are taken from the JSON alone: accessor counts times nodes and instances.
// The scenes that the project is tried on; skipped where they are not beside the checkout.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "shared/error/error.h"
#include "worker/scene/load.h"
#include "worker/scene/world.h"

namespace tilefarm {
namespace {

const std::filesystem::path kShared = TILEFARM_SHARED_DATA;

struct Expected {
    const char* file;
    uint32_t triangles;  // in the world, with all instances
    size_t instances, images;
    std::set<std::string> warnings;  // their features
};

void PrintTo(const Expected& expected, std::ostream* out) {
    *out << expected.file;
}

class SharedScene : public testing::TestWithParam<Expected> {};

TEST_P(SharedScene, LoadsAsExpected) {
    const auto path = kShared / "scenes" / GetParam().file;
    if (!std::filesystem::exists(path)) {
        GTEST_SKIP() << "no shared data";
    }
    const Scene scene = loadGltf(path);
    const WorldGeometry world = flatten(scene);
    EXPECT_EQ(world.triangleCount() + world.degenerateTriangles + scene.degenerateTriangles,
              GetParam().triangles)
        << scene.degenerateTriangles << " degenerate in meshes, " << world.degenerateTriangles
        << " in the world";
    EXPECT_EQ(scene.instances.size(), GetParam().instances);
    EXPECT_EQ(scene.images.size(), GetParam().images);
    std::set<std::string> features;
    for (const SceneWarning& warning : scene.warnings) {
        features.insert(warning.feature);
    }
    EXPECT_EQ(features, GetParam().warnings);
    for (const Mesh& mesh : scene.meshes) {
        EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
        EXPECT_TRUE(mesh.tangents.empty() || mesh.tangents.size() == mesh.positions.size());
    }
}

INSTANTIATE_TEST_SUITE_P(
    All, SharedScene,
    testing::Values(
        Expected{"stanford-bunny/bunny.glb", 144046, 1, 0, {}},
        Expected{"chinese-dragon/chinesedragon.gltf", 100960, 2, 0, {}},
        Expected{"cornell-box/CornellBox.glb", 36, 6, 0, {}},
        Expected{"damaged-helmet/DamagedHelmet.glb", 15452, 1, 4, {}},
        Expected{"bathroom/LAZIENKA.gltf", 38531, 82, 9, {}},
        Expected{"khronos-01_alpha_mask/01_alpha_mask.gltf", 2, 1, 1, {}},
        Expected{"khronos-03_skinned_cylinder/03_skinned_cylinder.gltf", 316, 1, 0, {"animations", "skins"}},
        Expected{"khronos-15_transmission/15_transmission.gltf", 4800, 5, 1, {}},
        Expected{"khronos-16_volume/16_volume.gltf", 296, 25, 2, {}},
        Expected{"khronos-17_ior/17_ior.gltf", 60, 5, 0, {}},
        Expected{"khronos-19_sheen/19_sheen.gltf", 6720, 7, 0, {"KHR_materials_sheen"}},
        Expected{"khronos-20_specular/20_specular.gltf", 6720, 7, 0, {"KHR_materials_specular"}},
        Expected{"khronos-24_gpu_instancing/24_gpu_instancing.gltf", 7656770, 1900, 0, {}},
        Expected{"khronos-25_anisotropy/25_anisotropy.gltf", 16664, 23, 4, {"KHR_materials_anisotropy"}}),
    [](const auto& scene) { return std::filesystem::path(scene.param.file).stem().string(); });

TEST(BadInputs, EachGivesAnErrorThatNamesFileAndPlace) {
    if (!std::filesystem::exists(kShared / "bad-inputs")) {
        GTEST_SKIP() << "no shared data";
    }
    size_t tried = 0;
    for (const auto& entry : std::filesystem::directory_iterator(kShared / "bad-inputs")) {
        if (entry.path().extension() != ".gltf") {
            continue;
        }
        ++tried;
        try {
            loadGltf(entry.path());
            ADD_FAILURE() << entry.path() << " was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::invalidArgument);
            EXPECT_NE(std::string(error.what()).find(entry.path().filename().string()), std::string::npos);
            ASSERT_EQ(error.faults.size(), 1u) << error.what();
            EXPECT_EQ(error.faults[0].pointer.front(), '/') << error.what();
        }
    }
    EXPECT_GE(tried, 4u);
}

}  // namespace
}  // namespace tilefarm
