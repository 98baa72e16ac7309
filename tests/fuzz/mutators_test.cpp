#include <gtest/gtest.h>

#include "shared/error/error.h"
#include "tests/fuzz/gltf_container.h"
#include "tests/fuzz/gltf_words.h"
#include "tests/fuzz/scene_seeds.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/gltf_file.h"
#include "worker/scene/load.h"

namespace tilefarm::fuzz {
namespace {

const Json kDocument =
    Json::parse(R"({"a": [1, 2.5, "x", null], "b": {"c": true, "d": {"e": -7}}, "name": "n"})");

TEST(JsonMutator, ChangesAlmostAlwaysAndDependsOnItsSeedAlone) {
    int changed = 0;
    for (uint32_t seed = 0; seed < 500; ++seed) {
        Json once = kDocument, again = kDocument;
        JsonMutator(seed, kGltfWords).mutate(once);
        JsonMutator(seed, kGltfWords).mutate(again);
        EXPECT_EQ(textOf(once), textOf(again));
        EXPECT_TRUE(once.is_object());
        changed += once != kDocument;
    }
    EXPECT_GT(changed, 400);
}

TEST(JsonMutator, DoesEverythingToAMemberInTime) {
    bool gone = false, otherType = false, huge = false, elements = false;
    for (uint32_t seed = 0; seed < 5000; ++seed) {
        Json document = kDocument;
        JsonMutator(seed, kGltfWords).mutate(document);
        const auto a = document.find("a");
        gone |= a == document.end();
        otherType |= a != document.end() && !a->is_array();
        elements |= a != document.end() && a->is_array() && a->size() > 4;
        huge |= a != document.end() && a->is_array() && !a->empty() && a->front() == 4294967295u;
    }
    EXPECT_TRUE(gone);
    EXPECT_TRUE(otherType);
    EXPECT_TRUE(elements);
    EXPECT_TRUE(huge);
}

TEST(JsonMutator, CrossesDocuments) {
    bool met = false;
    for (uint32_t seed = 0; seed < 200; ++seed) {
        Json document = kDocument;
        JsonMutator(seed, {}).cross(document, Json::parse(R"({"unique": [12345]})"));
        met |= textOf(document).find("12345") != std::string::npos;
    }
    EXPECT_TRUE(met);
}

TEST(GltfContainer, TakesFilesApartAndPutsThemTogether) {
    TemporaryFolder folder;
    for (const auto& path : writeSceneSeeds(folder.path())) {
        SCOPED_TRACE(path.filename());
        writeBytes(folder / "a.png", encodePng(1, 1, 3, 8, {1, 2, 3}));
        auto file = GltfContainer::parse(readFileBytes(path));
        ASSERT_TRUE(file);
        EXPECT_EQ(file->glb, path.extension() == ".glb");
        const auto buffer = file->buffer();
        ASSERT_FALSE(buffer.empty());
        for (int turn = 0; turn < 2; ++turn) {
            file->setBuffer(buffer);
            EXPECT_EQ(file->buffer(), buffer);
            writeBytes(folder / "again.gltf", file->bytes());
            EXPECT_NO_THROW(loadGltf(folder / "again.gltf"));
            file->turnIntoOther();
        }
    }
}

TEST(GltfContainer, RefusesWhatIsNoJson) {
    TemporaryFolder folder;
    const auto path = GltfBuilder::triangle().writeGlb(folder.path());
    auto bytes = readFileBytes(path);
    bytes[20] = std::byte{'x'};
    EXPECT_FALSE(GltfContainer::parse(bytes));
    EXPECT_FALSE(GltfContainer::parse({}));
    bytes.resize(21);
    EXPECT_FALSE(GltfContainer::parse(bytes));
}

}  // namespace
}  // namespace tilefarm::fuzz
