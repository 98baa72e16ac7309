#include "shared/job/job.h"
#include "worker/blob_cache/scene_folder.h"

#include "tests/unit/worker/blob_cache/blob_fixture.h"

namespace tilefarm {
namespace {

using SceneFolderTest = BlobFixture;

TEST_F(SceneFolderTest, LaysFilesOutUnderTheirOwnNames) {
    BlobCache cache(folder / "cache", 1 << 20);
    SceneBundle scene;
    scene.entry = "room/room.gltf";
    scene.environment = "sky.hdr";
    scene.files = {{"room/room.gltf", add("{}")}, {"room/tex/a b.png", add("png")}, {"sky.hdr", add("hdr")}};
    std::filesystem::path path;
    {
        const SceneFolder laidOut(cache, scene, source());
        path = laidOut.path();
        EXPECT_EQ(read(laidOut.entry()), "{}");
        EXPECT_EQ(read(laidOut.environment()), "hdr");
        EXPECT_EQ(read(path / "room" / "tex" / "a b.png"), "png");
    }
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_TRUE(std::filesystem::exists(blobFile(scene.files["sky.hdr"]))) << "the cache keeps its blobs";
}

TEST_F(SceneFolderTest, TwoNamesMayShareABlob) {
    BlobCache cache(folder / "cache", 1 << 20);
    const std::string same = add("same");
    SceneBundle scene{.entry = "a.glb", .files = {{"a.glb", same}, {"b.glb", same}}, .environment = ""};
    const SceneFolder laidOut(cache, scene, source());
    EXPECT_EQ(read(laidOut.path() / "b.glb"), "same");
    EXPECT_EQ(laidOut.environment(), "");
    EXPECT_EQ(fetches[same], 1);
}

TEST_F(SceneFolderTest, RefusesPathsThatLeaveTheFolder) {
    BlobCache cache(folder / "cache", 1 << 20);
    SceneBundle scene{.entry = "../a.glb", .files = {{"../a.glb", add("x")}}, .environment = ""};
    const Error error = errorOf([&] { SceneFolder(cache, scene, source()); });
    EXPECT_EQ(error.code, ErrorCode::invalidArgument);
    EXPECT_THAT(error.what(), testing::HasSubstr("../a.glb"));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "cache" / "scenes"));
}

TEST_F(SceneFolderTest, LeavesNothingBehindWhenABlobIsMissing) {
    BlobCache cache(folder / "cache", 1 << 20);
    SceneBundle scene{
        .entry = "a.glb", .files = {{"a.glb", add("x")}, {"b.bin", std::string(64, '0')}}, .environment = ""};
    EXPECT_EQ(codeOf([&] { SceneFolder(cache, scene, source()); }), ErrorCode::notFound);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "cache" / "scenes"));
}

}  // namespace
}  // namespace tilefarm
