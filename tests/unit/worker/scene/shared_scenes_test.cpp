// Expected counts are taken from the JSON alone: accessor counts times nodes and instances.
// The scenes that the project is tried on; skipped where they are not beside the checkout.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "shared/error/error.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/gltf_file.h"
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
        Expected{"damaged-helmet/DamagedHelmet.glb", 15452, 1, 4, {"occlusionTexture"}},
        Expected{"bathroom/LAZIENKA.gltf", 38531, 82, 9, {}},
        Expected{"khronos-01_alpha_mask/01_alpha_mask.gltf", 2, 1, 1, {}},
        Expected{"khronos-03_skinned_cylinder/03_skinned_cylinder.gltf", 316, 1, 0, {}},
        Expected{"khronos-15_transmission/15_transmission.gltf", 4800, 5, 1, {}},
        Expected{"khronos-16_volume/16_volume.gltf", 296, 25, 2, {"thicknessTexture"}},
        Expected{"khronos-17_ior/17_ior.gltf", 60, 5, 0, {}},
        Expected{"khronos-19_sheen/19_sheen.gltf", 6720, 7, 1, {}},
        Expected{"khronos-20_specular/20_specular.gltf", 6720, 7, 1, {}},
        Expected{"khronos-24_gpu_instancing/24_gpu_instancing.gltf", 7656770, 1900, 0, {}},
        Expected{"khronos-25_anisotropy/25_anisotropy.gltf", 16664, 23, 7, {}}),
    [](const auto& scene) { return std::filesystem::path(scene.param.file).stem().string(); });

TEST(SharedTangents, AreThoseThatBlenderWrote) {
    const auto folder = kShared / "scenes/khronos-25_anisotropy";
    if (!std::filesystem::exists(folder)) {
        GTEST_SKIP() << "no shared data";
    }
    // The same file twice, once without its tangents, beside links to what it refers to.
    TemporaryFolder copy;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        std::filesystem::create_symlink(std::filesystem::absolute(entry.path()),
                                        copy / entry.path().filename().string());
    }
    const std::vector<std::byte> bytes = readFileBytes(folder / "25_anisotropy.gltf");
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    for (size_t at = text.find("\"TANGENT\""); at != std::string::npos; at = text.find("\"TANGENT\"", at)) {
        text.replace(at, 9, "\"_ABSENT\"");
    }
    writeText(copy / "generated.gltf", text);
    const Scene written = loadGltf(copy / "25_anisotropy.gltf"),
                generated = loadGltf(copy / "generated.gltf");
    size_t compared = 0;
    for (size_t m = 0; m < written.meshes.size(); ++m) {
        const Mesh &theirs = written.meshes[m], &ours = generated.meshes[m];
        for (size_t t = 0; t < theirs.triangles.size() && !theirs.tangents.empty(); ++t) {
            for (int k = 0; k < 3; ++k, ++compared) {
                const glm::vec4 a = theirs.tangents[theirs.triangles[t][k]],
                                b = ours.tangents[ours.triangles[t][k]];
                ASSERT_GT(glm::dot(glm::vec3(a), glm::vec3(b)), 0.999999f) << theirs.name << " " << t;
                ASSERT_EQ(a.w, b.w);
            }
        }
    }
    EXPECT_EQ(compared, 15624u);
}

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
