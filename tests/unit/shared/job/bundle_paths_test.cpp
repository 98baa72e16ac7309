#include "shared/job/bundle_paths.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

TEST(BundlePaths, HaveOneForm) {
    for (const char* path :
         {"tex.png", "./tex.png", "sub/../tex.png", "sub//..//tex.png", "a/b/../../tex.png"})
        EXPECT_EQ(tidyPath(path), (TidyPath{0, "tex.png"})) << path;
    EXPECT_EQ(tidyPath("sub//tex.png").text(), "sub/tex.png");
    EXPECT_EQ(tidyPath("../textures/./tex.png"), (TidyPath{1, "textures/tex.png"}));
    EXPECT_EQ(tidyPath("a/../../../b.bin").text(), "../../b.bin");
    EXPECT_EQ(tidyPath("/etc/passwd").rest, "/etc/passwd");
    EXPECT_EQ(tidyPath(".."), (TidyPath{1, ""}));
}

TEST(BundlePaths, AboveTheSceneOnlyWhatLooksLikeAPartOfIt) {
    EXPECT_EQ(referenceFault(tidyPath("notes.txt")), "");
    EXPECT_EQ(referenceFault(tidyPath("../textures/WOOD.PNG")), "");
    EXPECT_EQ(referenceFault(tidyPath("../../s.bin")), "");
    for (const char* path : {"../../.ssh/id_rsa", "../secret.txt", "/etc/passwd", "", "..", "a\\b.png"})
        EXPECT_NE(referenceFault(tidyPath(path)), "") << path;
}

TEST(BundlePaths, TheRootIsAsFarUpAsTheFarthestReference) {
    const BundleRoot beside("project/models/chair.gltf", 0);
    EXPECT_EQ(beside.entry(), "chair.gltf");
    EXPECT_EQ(beside.nameOf(tidyPath("tex/wood.png")), "tex/wood.png");
    EXPECT_EQ(beside.fileOf(tidyPath("wood.png")), "project/models/wood.png");

    const BundleRoot above("/project/models/chair.gltf", 1);
    EXPECT_EQ(above.entry(), "models/chair.gltf");
    EXPECT_EQ(above.nameOf(tidyPath("chair.bin")), "models/chair.bin");
    EXPECT_EQ(above.nameOf(tidyPath("../textures/wood.png")), "textures/wood.png");
    EXPECT_EQ(above.fileOf(tidyPath("../textures/wood.png")), "/project/textures/wood.png");
    EXPECT_EQ(levelsAbove(above.entry()), 1u);
}

TEST(BundlePaths, ThereIsNothingAboveAllFolders) {
    EXPECT_EQ(BundleRoot("/a/b/s.gltf", 2).entry(), "a/b/s.gltf");
    EXPECT_EQ(codeOf([] { BundleRoot("/a/b/s.gltf", 3); }), ErrorCode::invalidArgument);
}

}  // namespace
}  // namespace tilefarm
