#include "shared/gltf/picture_size.h"
#include "shared/job/job.h"

#include <gtest/gtest.h>

namespace tilefarm {
namespace {

GltfBytes pictureBytes(const std::string& text) {
    return bytesOfGltf(std::as_bytes(std::span(text)));
}

const std::string kScene = R"({
    "cameras": [
        {"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": 2}},
        {"type": "perspective", "name": "free", "perspective": {"yfov": 1}},
        {"type": "orthographic", "orthographic": {"xmag": -1, "ymag": 4}},
        {"type": "perspective", "name": "square", "perspective": {"yfov": 1, "aspectRatio": 1}}],
    "nodes": [{"camera": 1}, {"name": "wide", "camera": 0}, {"camera": 2, "name": "tall"},
              {"children": [5, 1], "name": "group"},
              {"camera": 3, "extensions": {"KHR_node_visibility": {"visible": false}}}, {"name": "deep"}],
    "scenes": [{"nodes": [0]}, {"nodes": [3, 0, 2, 4]}], "scene": 1})";

ImageSpec sizeOf(const std::string& camera, ImageSpec image = {}, const std::string& scene = kScene) {
    JobSpec job;
    job.camera = camera;
    job.image = image;
    return pictureSize(pictureBytes(scene), job);
}

TEST(PictureSize, HasTheAspectOfTheCameraAndALongerSideOf640) {
    EXPECT_EQ(sizeOf("auto"), (ImageSpec{640, 320})) << "the first that the scene's nodes lead to";
    EXPECT_EQ(sizeOf("wide"), (ImageSpec{640, 320}));
    EXPECT_EQ(sizeOf("tall"), (ImageSpec{160, 640}));
}

TEST(PictureSize, KeepsWhatIsGiven) {
    EXPECT_EQ(sizeOf("wide", {100, 100, 32}), (ImageSpec{100, 100, 32}));
    EXPECT_EQ(sizeOf("wide", {101, 0}), (ImageSpec{101, 51}));
    EXPECT_EQ(sizeOf("wide", {0, 101}), (ImageSpec{202, 101}));
    EXPECT_EQ(sizeOf("wide", {1, 0}), (ImageSpec{1, 1}));
    EXPECT_EQ(sizeOf("tall", {32768, 0}), (ImageSpec{32768, 32768})) << "no larger than a picture may be";
}

TEST(PictureSize, IsTheUsualOneWhereNobodyFramedAView) {
    const ImageSpec usual{640, 360};
    EXPECT_EQ(sizeOf("free"), usual) << "a camera without an aspectRatio";
    EXPECT_EQ(sizeOf("square"), usual) << "a hidden camera is not there";
    EXPECT_EQ(
        sizeOf("auto", {}, R"({"cameras": [{"type": "perspective", "perspective": {"aspectRatio": 2}}]})"),
        usual);
    EXPECT_EQ(sizeOf("auto", {}, "scene"), usual);
    EXPECT_EQ(sizeOf("auto", {}, R"({"cameras": 3, "nodes": {"a": [{}]}, "scenes": [1], "scene": -1})"),
              usual);
    EXPECT_EQ(sizeOf("auto", {}, R"({"cameras": [{"type": "perspective", "perspective": {"aspectRatio": -1}}],
                                     "nodes": [{"camera": 0}]})"),
              usual);
}

TEST(PictureSize, OfAPanoramaIsTwiceAsWideAsHigh) {
    JobSpec job;
    job.view.kind = ViewKind::panorama;
    EXPECT_EQ(pictureSize(pictureBytes(kScene), job), (ImageSpec{640, 320}));
    job.view.kind = ViewKind::perspective;
    EXPECT_EQ(pictureSize(pictureBytes(kScene), job), (ImageSpec{640, 360}));
}

}  // namespace
}  // namespace tilefarm
