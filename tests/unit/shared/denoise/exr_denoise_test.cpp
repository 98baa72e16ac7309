#include "shared/denoise/exr_denoise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "shared/error/error.h"
#include "shared/image/exr.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::vector<std::string> kGuides{"R",          "G",          "B",        "A",        "variance.R",
                                       "variance.G", "variance.B", "samples",  "albedo.R", "albedo.G",
                                       "albedo.B",   "normal.X",   "normal.Y", "normal.Z", "Z"};

FloatImage frame(uint32_t width, uint32_t height) {
    FloatImage image{width, height, kGuides, {}};
    image.channels.emplace_back("uv.U");  // nothing of the denoiser's
    for (size_t c = 0; c < image.channels.size(); ++c) {
        auto& plane = image.planes.emplace_back(image.pixelCount());
        for (size_t i = 0; i < plane.size(); ++i)
            plane[i] = 1 + 0.1f * std::sin(static_cast<float>(i * (c + 1)));
        if (image.channels[c] == "samples") std::fill(plane.begin(), plane.end(), 16.f);
    }
    return image;
}

TEST(DenoiseExr, AddsItsChannelsToAFileThatKeepsItsOwn) {
    const TemporaryFolder folder;
    const FloatImage raw = frame(70, 150);
    writeExr(folder / "in.exr", raw, {{"job", "7"}});
    denoiseExr(folder / "in.exr", folder / "out.exr", {});

    const FloatImage out = readExr(folder / "out.exr");
    for (size_t c = 0; c < raw.channels.size(); ++c) {
        const auto& kept = out.plane(raw.channels[c]);
        EXPECT_EQ(std::memcmp(kept.data(), raw.planes[c].data(), kept.size() * sizeof(float)), 0)
            << raw.channels[c];
    }
    EXPECT_EQ(out.channels.size(), raw.channels.size() + 3);
    EXPECT_NE(out.plane("denoised.R"), raw.plane("R"));
    const ImageAttributes attributes = readExrAttributes(folder / "out.exr");
    EXPECT_EQ(attributes.at("job"), "7");
    EXPECT_EQ(attributes.at("denoiser"), denoiserText({}));
}

TEST(DenoiseExr, MayBeDoneInPlaceAndAgain) {
    const TemporaryFolder folder;
    const fs::path file = folder / "a.exr";
    writeExr(file, frame(20, 20));
    denoiseExr(file, file, {.radius = 2});
    const FloatImage once = readExr(file);
    denoiseExr(file, file, {.radius = 2});  // from the raw picture, not from its own
    const FloatImage twice = readExr(file);
    EXPECT_EQ(twice.channels, once.channels);
    EXPECT_EQ(twice.planes, once.planes);
}

TEST(DenoiseExr, NamesEveryChannelThatIsMissing) {
    const TemporaryFolder folder;
    FloatImage image = frame(8, 8);
    image.channels[4] = "other";    // variance.R
    image.channels[13] = "normal";  // normal.Z
    writeExr(folder / "in.exr", image);
    const Error error = errorOf([&] { denoiseExr(folder / "in.exr", folder / "out.exr", {}); });
    EXPECT_EQ(error.code, ErrorCode::invalidArgument);
    EXPECT_THAT(error.what(), AllOf(HasSubstr("in.exr"), HasSubstr("variance.R"), HasSubstr("normal.Z"),
                                    Not(HasSubstr("variance.G"))));
    EXPECT_FALSE(fs::exists(folder / "out.exr"));
}

TEST(DenoiseExr, RefusesWhatIsNoWholeFile) {
    const TemporaryFolder folder;
    writeExr(folder / "in.exr", frame(64, 64));
    for (const uint64_t bytes : {uint64_t{0}, uint64_t{40}, fs::file_size(folder / "in.exr") / 2}) {
        fs::copy_file(folder / "in.exr", folder / "cut.exr", fs::copy_options::overwrite_existing);
        fs::resize_file(folder / "cut.exr", bytes);
        EXPECT_EQ(codeOf([&] { denoiseExr(folder / "cut.exr", folder / "out.exr", {}); }),
                  ErrorCode::invalidArgument)
            << bytes;
        EXPECT_FALSE(fs::exists(folder / "out.exr"));
    }
    EXPECT_THAT(errorOf([&] { denoiseExr(folder / "none.exr", folder / "out.exr", {}); }).what(),
                HasSubstr("none.exr"));
}

}  // namespace
}  // namespace tilefarm
