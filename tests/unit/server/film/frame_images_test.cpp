#include "server/film/frame_images.h"

#include <gtest/gtest.h>

#include <fstream>
#include <future>

#include "shared/digest/digest.h"
#include "shared/image/exr.h"
#include "shared/image/png.h"
#include "tests/support/expect_error.h"
#include "tests/unit/server/support/test_farm.h"

namespace tilefarm {
namespace {

std::vector<std::byte> bytesOf(const ImageFile& image) {
    std::vector<std::byte> bytes(image.bytes);
    image.file->readAt(0, bytes);
    return bytes;
}

QueueConfig oneFrameLeases() {
    QueueConfig config;
    config.mostPixelsPerLease = 6 * 16 * 16;
    return config;
}

TEST(FrameImages, WritesTheFinalImageOnceAndCompletesTheJob) {
    TestFarm farm;
    const JobSpec spec = smallJob();
    const std::string id = farm.scheduler->submit(spec).job.id;
    farm.finish();
    EXPECT_EQ(farm.job(id).state, JobState::completed);
    EXPECT_EQ(farm.job(id).framesDone, 1u);
    EXPECT_FALSE(std::filesystem::exists(farm.folder / ("films/" + id)));

    const ImageFile image = farm.images->exr(id, 0);
    EXPECT_FALSE(image.partial);
    EXPECT_EQ(image.sha256, sha256Hex(bytesOf(image)));
    const FloatImage read = readExr(bytesOf(image), "final");
    const auto wanted = renderFrame(spec);
    ASSERT_EQ(read.width, 40u);
    for (const FilmTile& tile : wanted) {
        const size_t at = size_t{tile.rect.y} * 40 + tile.rect.x;
        EXPECT_EQ(read.plane("R")[at], static_cast<float>(tile.pixels[0].mean[0]));
        EXPECT_EQ(read.plane("variance.G")[at], static_cast<float>(tile.pixels[0].varianceOfMean(1)));
        EXPECT_EQ(read.plane("samples.X")[at], 8.0f);
    }
}

TEST(FrameImages, WritesTheNamesOfTheScenesMattes) {
    TestFarm farm;
    const std::string gltf = R"({"nodes": [{"name": "Chair"}], "materials": [{}]})";
    const auto writer = farm.blobs.create(sha256Hex(gltf));
    writer->write(std::as_bytes(std::span(gltf)));
    writer->commit();
    JobSpec spec = smallJob();
    spec.scene.files = {{"a.glb", sha256Hex(gltf)}};
    spec.output.cryptomatte = true;
    const std::string id = farm.scheduler->submit(spec).job.id;
    farm.finish();
    const auto metadata = readExrMetadata(farm.folder / ("images/" + id + "/0.exr"));
    EXPECT_EQ(codeOf([&] { farm.images->sidecar(id, "CryptoObject.json"); }), ErrorCode::notFound);
    EXPECT_NE(metadata.at("cryptomatte/3ae39a5/manifest").find("\"Chair\""), std::string::npos);
    EXPECT_NE(metadata.at("cryptomatte/be359d6/manifest").find("\"materials/0\""), std::string::npos);
    const FloatImage read = readExr(bytesOf(farm.images->exr(id, 0)), "final");
    EXPECT_EQ(read.plane("CryptoObject00.R")[5], 1e30f) << "seen by 7 of 8 samples";
    EXPECT_EQ(read.plane("CryptoObject00.G")[5], 0.875f);
    EXPECT_EQ(read.plane("CryptoObject00.A")[5], 0.125f);
}

TEST(FrameImages, HandsOutManifestsThatAreTooLongForAHeader) {
    TestFarm farm;
    std::string gltf = R"({"nodes": [{"name": "Chair"})";
    for (int i = 0; i < 40; ++i) gltf += R"(, {"name": "Chair of the row )" + std::to_string(i) + "\"}";
    gltf += "]}";
    const auto writer = farm.blobs.create(sha256Hex(gltf));
    writer->write(std::as_bytes(std::span(gltf)));
    writer->commit();
    JobSpec spec = smallJob();
    spec.scene.files = {{"a.glb", sha256Hex(gltf)}};
    spec.output.cryptomatte = true;
    const std::string id = farm.scheduler->submit(spec).job.id;
    farm.finish();
    const auto metadata = readExrMetadata(farm.folder / ("images/" + id + "/0.exr"));
    EXPECT_FALSE(metadata.contains("cryptomatte/3ae39a5/manifest"));
    EXPECT_TRUE(metadata.contains("cryptomatte/be359d6/manifest")) << "two names are short";
    const auto files = sidecarsNamedIn(metadata);
    ASSERT_EQ(files.size(), 1u);
    EXPECT_NE(farm.images->sidecar(id, files[0]).find("\"Chair of the row 39\""), std::string::npos);
    EXPECT_EQ(codeOf([&] { farm.images->sidecar("other", files[0]); }), ErrorCode::notFound);
    for (const auto& [key, value] : metadata) EXPECT_LE(value.size(), 250u) << key;
}

TEST(FrameImages, SaysWhatMadeTheImage) {
    TestFarm farm;
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    farm.finish();
    const auto path = farm.folder / ("images/" + id + "/0.exr");
    const ImageAttributes attributes = readExrAttributes(path);
    EXPECT_EQ(attributes.at("job"), id);
    EXPECT_EQ(attributes.at("state"), "complete");
    EXPECT_EQ(attributes.at("devices"), "device");
    EXPECT_EQ(attributes.at("drivers"), "driver");
    EXPECT_EQ(attributes.at("samples"), "8");
    EXPECT_EQ(attributes.at("scene").size(), 64u);
    EXPECT_NE(attributes.at("settings").find("\"tileSize\":16"), std::string::npos);
}

TEST(FrameImages, ShowsAFrameInWorkAsFarAsItIsMerged) {
    TestFarm farm(oneFrameLeases());
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    farm.deliver(farm.lease());
    const ImageFile first = farm.images->exr(id, 0);
    EXPECT_TRUE(first.partial);
    EXPECT_EQ(readExr(bytesOf(first), "partial").plane("samples.X")[0], 1.0f);
    farm.deliver(farm.lease());
    farm.clock.advance(Milliseconds(60000));
    const ImageFile second = farm.images->exr(id, 0);
    EXPECT_EQ(readExr(bytesOf(second), "partial").plane("samples.X")[0], 2.0f);
    EXPECT_NE(first.sha256, second.sha256);
    EXPECT_EQ(bytesOf(first).size(), first.bytes);  // still readable for who holds it
}

// An EXR of a large frame takes a minute to write; here it waits for one of its tiles.
TEST(FrameImages, PaintsOnePictureWhileAnExrIsBeingWritten) {
    TestFarm farm(oneFrameLeases());
    const std::string large = farm.scheduler->submit(smallJob()).job.id;
    farm.deliver(farm.lease());
    auto tile = std::make_unique<TileLocks::Hold>(farm.films->locks(), farm.job(large).key, 0,
                                                  std::vector<uint32_t>{5});
    auto exr = std::async(std::launch::async, [&] { return farm.images->exr(large, 0).partial; });
    farm.scheduler->pause(large);
    const std::string small = farm.scheduler->submit(smallJob()).job.id;
    farm.deliver(farm.lease());
    auto png = std::async(std::launch::async, [&] { return farm.images->png(small, 0, {}, 0).partial; });
    EXPECT_EQ(png.wait_for(std::chrono::seconds(20)), std::future_status::ready);
    tile.reset();
    EXPECT_TRUE(exr.get());
    EXPECT_TRUE(png.get());
}

TEST(FrameImages, FinishesAFrameAfterACrashInBetween) {
    for (const char* step : {"image written", "frame completed"}) {
        TestFarm farm;
        const std::string id = farm.scheduler->submit(smallJob()).job.id;
        while (const auto lease = farm.tryLease()) farm.deliver(*lease);
        farm.probe = [step](std::string_view reached) {
            if (reached == step) throw std::runtime_error("crash");
        };
        EXPECT_THROW(farm.images->finishFrames(), std::runtime_error);
        farm.probe = nullptr;
        farm.reopen();
        farm.images->removeSpentFilms();
        EXPECT_TRUE(farm.images->finishFrames().empty());
        EXPECT_EQ(farm.job(id).state, JobState::completed) << step;
        EXPECT_EQ(farm.job(id).framesDone, 1u) << step;
        EXPECT_FALSE(std::filesystem::exists(farm.folder / ("films/" + id + "/0.film"))) << step;
        EXPECT_FALSE(farm.images->exr(id, 0).partial);
    }
}

TEST(FrameImages, KeepsAFrameWhoseImageCannotBeWritten) {
    TestFarm farm;
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    while (const auto lease = farm.tryLease()) farm.deliver(*lease);
    std::ofstream(farm.folder / ("images/" + id)) << "in the way";
    EXPECT_EQ(farm.images->finishFrames().size(), 1u);
    EXPECT_EQ(farm.frame(id).state, FrameState::finishing);
    std::filesystem::remove(farm.folder / ("images/" + id));
    EXPECT_TRUE(farm.images->finishFrames().empty());
    EXPECT_EQ(farm.job(id).state, JobState::completed);
}

TEST(FrameImages, GivesPicturesOfWorkAndOfFinishedFramesAlike) {
    TestFarm farm;
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    while (const auto lease = farm.tryLease()) farm.deliver(*lease);
    const Picture partial = farm.images->png(id, 0, {}, 0);
    EXPECT_TRUE(partial.partial);
    farm.images->finishFrames();
    const Picture complete = farm.images->png(id, 0, {}, 0);
    EXPECT_FALSE(complete.partial);
    EXPECT_EQ(*partial.png, *complete.png);  // the same film, by two ways
    const Picture brighter = farm.images->png(id, 0, {.curve = ToneCurve::linear, .exposure = 1}, 0);
    EXPECT_NE(brighter.sha256, complete.sha256);
    const Picture small = farm.images->png(id, 0, {}, 20);
    EXPECT_LT(small.png->size(), complete.png->size());
    EXPECT_EQ(small.sha256, sha256Hex(*small.png));
}

TEST(FrameImages, AddsADenoisedPictureToACompleteFrameThatAsksForIt) {
    TestFarm farm;
    JobSpec spec = smallJob();
    const std::string plain = farm.scheduler->submit(spec).job.id;
    farm.finish();
    EXPECT_EQ(codeOf([&] { farm.images->png(plain, 0, {}, 0, true); }), ErrorCode::conflict);

    spec.output.denoise = true;
    const std::string id = farm.scheduler->submit(spec).job.id;
    while (const auto lease = farm.tryLease()) farm.deliver(*lease);
    EXPECT_EQ(readExr(bytesOf(farm.images->exr(id, 0)), "partial").find("denoised.R"), -1);
    EXPECT_EQ(codeOf([&] { farm.images->png(id, 0, {}, 0, true); }), ErrorCode::conflict);
    farm.images->finishFrames();
    const FloatImage image = readExr(bytesOf(farm.images->exr(id, 0)), "final");
    const FloatImage raw = readExr(bytesOf(farm.images->exr(plain, 0)), "raw");
    for (size_t c = 0; c < raw.channels.size(); ++c) EXPECT_EQ(image.plane(raw.channels[c]), raw.planes[c]);
    EXPECT_NE(image.plane("denoised.R"), raw.plane("R"));
    EXPECT_TRUE(std::filesystem::is_empty(farm.folder / "cache"));

    const Picture shown = farm.images->png(id, 0, {}, 0), denoised = farm.images->png(id, 0, {}, 0, true);
    EXPECT_EQ(*shown.png, *farm.images->png(plain, 0, {}, 0).png);
    EXPECT_NE(*denoised.png, *shown.png);
    EXPECT_EQ(farm.frame(id).relativeError, farm.frame(plain).relativeError);
}

TEST(FrameImages, NamesAFrameThatHasNotBegunOrIsNone) {
    TestFarm farm;
    const std::string id = farm.scheduler->submit(smallJob()).job.id;
    EXPECT_EQ(codeOf([&] { farm.images->exr(id, 0); }), ErrorCode::notFound);
    EXPECT_EQ(codeOf([&] { farm.images->exr(id, 1); }), ErrorCode::notFound);
    EXPECT_EQ(codeOf([&] { farm.images->png("none", 0, {}, 0); }), ErrorCode::notFound);
}

TEST(FrameImages, FinishesFramesOneAfterTheOther) {
    TestFarm farm;
    JobSpec spec = smallJob();
    spec.frames = {.first = 5, .count = 3};
    const std::string id = farm.scheduler->submit(spec).job.id;
    farm.finish();
    EXPECT_EQ(farm.job(id).state, JobState::completed);
    EXPECT_EQ(farm.job(id).framesDone, 3u);
    const FloatImage last = readExr(bytesOf(farm.images->exr(id, 7)), "last");
    EXPECT_EQ(last.plane("R")[0], static_cast<float>(renderFrame(spec, 7)[0].pixels[0].mean[0]));
}

}  // namespace
}  // namespace tilefarm
