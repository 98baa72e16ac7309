// EXR environments by what their headers say.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/load.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

Imath::Box2i boxOf(int x, int y, int width, int height) {
    return {{x, y}, {x + width - 1, y + height - 1}};
}

/// A sky of the channels, each with its values row by row over the data window.
struct ExrSky {
    Imf::Header header;
    std::vector<std::pair<std::string, std::vector<float>>> channels;
    Imf::PixelType type = Imf::FLOAT;

    explicit ExrSky(const Imath::Box2i& data) : ExrSky(data, data) {}
    ExrSky(const Imath::Box2i& data, const Imath::Box2i& display) : header(display, data) {
        header.compression() = Imf::NO_COMPRESSION;
    }
    size_t texels() const {
        const Imath::V2i size = header.dataWindow().size() + Imath::V2i(1);
        return static_cast<size_t>(size.x) * static_cast<size_t>(size.y);
    }
    ExrSky& rgb(const std::function<std::array<float, 3>(int x, int y)>& color) {
        channels = {{"R", {}}, {"G", {}}, {"B", {}}};
        const Imath::Box2i& w = header.dataWindow();
        for (int y = w.min.y; y <= w.max.y; ++y)
            for (int x = w.min.x; x <= w.max.x; ++x)
                for (size_t c = 0; c < 3; ++c) channels[c].second.push_back(color(x, y)[c]);
        return *this;
    }
    ExrSky& fill(const char* channel, float value) {
        channels.emplace_back(channel, std::vector<float>(texels(), value));
        return *this;
    }
    fs::path write(const fs::path& path) {
        const Imath::Box2i& w = header.dataWindow();
        for (const auto& [name, values] : channels) header.channels().insert(name, Imf::Channel(type));
        std::vector<std::vector<half>> halves;
        Imf::FrameBuffer buffer;
        for (const auto& [name, values] : channels) {
            halves.emplace_back(values.begin(), values.end());
            const void* data =
                type == Imf::HALF ? static_cast<const void*>(halves.back().data()) : values.data();
            buffer.insert(name, Imf::Slice::Make(type, data, w));
        }
        Imf::OutputFile file(path.c_str(), header, 0);
        file.setFrameBuffer(buffer);
        file.writePixels(w.max.y - w.min.y + 1);
        return path;
    }
};

struct ExrEnvironment : testing::Test {
    TemporaryFolder folder;
    Scene load(ExrSky& sky) { return load(sky.write(folder / "sky.exr")); }
    static Scene load(const fs::path& path) {
        Scene scene;
        loadEnvironment(scene, path);
        return scene;
    }
    static std::array<float, 3> texel(const Scene& scene, uint32_t x, uint32_t y) {
        const Image& image = scene.environment.image;
        const float* t = &image.rgbaFloat[4 * (size_t{y} * image.width + x)];
        return {t[0], t[1], t[2]};
    }
    static void expectColor(const Scene& scene, const std::array<double, 3>& color, double tolerance) {
        for (uint32_t y = 0; y < scene.environment.image.height; ++y)
            for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(texel(scene, 0, y)[c], color[c], tolerance) << c;
    }
    static std::string noteOf(const Scene& scene) {
        return scene.warnings.size() == 1 ? scene.warnings[0].instead : "not one warning";
    }
};

TEST_F(ExrEnvironment, IsTheDisplayWindowAndBlackBeyondTheDataWindow) {
    std::mt19937 random(5);
    const auto any = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
    const auto colorOf = [](int x, int y) {
        return std::array{100.0f + static_cast<float>(x), 100.0f + static_cast<float>(y), 1.0f};
    };
    for (int round = 0; round < 40; ++round) {
        const int height = any(1, 9), x0 = any(-20, 20), y0 = any(-20, 20);
        const Imath::Box2i display = boxOf(x0, y0, 2 * height, height);
        const Imath::Box2i data = boxOf(x0 + any(-12, 12), y0 + any(-8, 8), any(1, 25), any(1, 12));
        const Scene scene = load(ExrSky(data, display).rgb(colorOf));
        ASSERT_EQ(scene.environment.image.width, static_cast<uint32_t>(2 * height));
        ASSERT_EQ(scene.environment.image.height, static_cast<uint32_t>(height));
        bool anything = false;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < 2 * height; ++x) {
                const bool inside = data.intersects(Imath::V2i(x0 + x, y0 + y));
                anything = anything || inside;
                const auto wanted = inside ? colorOf(x0 + x, y0 + y) : std::array<float, 3>{};
                ASSERT_EQ(texel(scene, static_cast<uint32_t>(x), static_cast<uint32_t>(y)), wanted) << round;
            }
        EXPECT_EQ(scene.warnings.empty(), anything) << round;
    }
}

TEST_F(ExrEnvironment, OfADisplayWindowThatItsDataDoNotBearOutIsRefused) {
    for (const auto& display : {boxOf(0, 0, 60000, 30000), boxOf(-(1 << 29), -(1 << 29), 1 << 30, 1 << 30)}) {
        ExrSky sky(boxOf(0, 0, 2, 2), display);
        const fs::path path = sky.fill("Y", 1).write(folder / "sky.exr");
        EXPECT_THAT(errorOf([&] { load(path); }).what(), HasSubstr("sky.exr: its display window"));
    }
}

// Every texel of 2 x 2 faces lies on a corner of the cube; where it holds the corner's place, bilinear
// interpolation gives the point of the cube that a direction meets.
TEST_F(ExrEnvironment, OfACubeMapShowsEveryFaceWhereItPoints) {
    // Corners by x, y and z as ImfEnvmap.h numbers them: a bit each for +x, +y and +z.
    const auto corner = [](int i) {
        return std::array{i & 1 ? 1.0f : 0.0f, i & 2 ? 1.0f : 0.0f, i & 4 ? 1.0f : 0.0f};
    };
    constexpr int faces[6][4] = {{3, 7, 1, 5}, {6, 2, 4, 0}, {6, 7, 2, 3},
                                 {0, 1, 4, 5}, {7, 6, 5, 4}, {2, 3, 0, 1}};
    ExrSky sky(boxOf(3, -5, 2, 12), boxOf(0, 0, 640, 480));
    sky.rgb([&](int x, int y) { return corner(faces[(y + 5) / 2][(y + 5) % 2 * 2 + x - 3]); });
    Imf::addEnvmap(sky.header, Imf::ENVMAP_CUBE);
    const Scene scene = load(sky);
    EXPECT_TRUE(scene.warnings.empty());
    const Image& image = scene.environment.image;
    ASSERT_EQ(image.width, 2 * image.height);
    const double texelSize = glm::two_pi<double>() / image.width;
    for (uint32_t y = 0; y < image.height; y += 3)
        for (uint32_t x = 0; x < image.width; x += 3) {
            const double phi = ((x + 0.5) / image.width - 0.5) * glm::two_pi<double>(),
                         theta = (y + 0.5) / image.height * glm::pi<double>();
            const glm::dvec3 d(std::sin(theta) * std::cos(phi), std::cos(theta),
                               std::sin(theta) * std::sin(phi));
            const glm::dvec3 wanted = d / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) * 0.5 + 0.5;
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(texel(scene, x, y)[size_t(c)], wanted[c], 1.5 * texelSize) << x << " " << y;
        }
}

TEST_F(ExrEnvironment, OfACubeMapWithoutSixFacesIsRefused) {
    ExrSky sky(boxOf(0, 0, 4, 20));
    sky.fill("Y", 1);
    Imf::addEnvmap(sky.header, Imf::ENVMAP_CUBE);
    EXPECT_THAT(errorOf([&] { load(sky); }).what(), HasSubstr("4 x 20 texels; six faces"));
}

Imf::Chromaticities acescg() {
    return {{0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}};
}

TEST_F(ExrEnvironment, IsConvertedFromItsPrimaries) {
    // As ACES publishes the matrix from AP1 to linear Rec. 709, by Bradford's adaptation.
    constexpr double matrix[3][3] = {
        {1.70505, -0.62179, -0.08326}, {-0.13026, 1.14080, -0.01055}, {-0.02400, -0.12897, 1.15297}};
    ExrSky sky(boxOf(0, 0, 2, 1));
    sky.fill("R", 0.6f).fill("G", 0.5f).fill("B", 0.4f);
    Imf::addChromaticities(sky.header, acescg());
    const Scene scene = load(sky);
    std::array<double, 3> wanted{};
    for (size_t r = 0; r < 3; ++r) wanted[r] = matrix[r][0] * 0.6 + matrix[r][1] * 0.5 + matrix[r][2] * 0.4;
    expectColor(scene, wanted, 1e-5);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(ExrEnvironment, ClampsColoursThatRec709DoesNotHave) {
    ExrSky sky(boxOf(0, 0, 2, 1));
    sky.fill("R", 1).fill("G", 0).fill("B", 0);
    Imf::addChromaticities(sky.header, acescg());
    const Scene scene = load(sky);
    expectColor(scene, {1.70505, 0, 0}, 1e-5);
    EXPECT_THAT(noteOf(scene), HasSubstr("2 have a negative channel, which becomes 0"));
}

TEST_F(ExrEnvironment, KeepsItsBitsWherePrimariesAreThoseOfRec709) {
    ExrSky sky(boxOf(0, 0, 2, 1));
    sky.fill("R", 0.1f).fill("G", 1e-30f).fill("B", 3e38f);
    Imf::addChromaticities(
        sky.header, Imf::Chromaticities({0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.31271f, 0.32902f}));
    EXPECT_EQ(texel(load(sky), 1, 0), (std::array{0.1f, 1e-30f, 3e38f}));
}

TEST_F(ExrEnvironment, TakesItsAdoptedNeutralForWhite) {
    ExrSky sky(boxOf(0, 0, 2, 1));
    // The colour whose x and y those are: Y = 1, X = x / y, Z = (1 − x − y) / y, as Rec. 709.
    const Imath::V3f xyz(0.44757f / 0.40745f, 1, (1 - 0.44757f - 0.40745f) / 0.40745f);
    const Imath::V3f rgb = xyz * Imf::XYZtoRGB(Imf::Chromaticities(), 1);
    sky.fill("R", rgb.x).fill("G", rgb.y).fill("B", rgb.z);
    Imf::addAdoptedNeutral(sky.header, {0.44757f, 0.40745f});
    expectColor(load(sky), {1, 1, 1}, 1e-5);
}

TEST_F(ExrEnvironment, OfLuminanceAndChromaIsMadeRgb) {
    for (const bool wide : {false, true}) {
        ExrSky sky(boxOf(0, 0, 2, 1));
        // Published luminance of ACEScg and of Rec. 709.
        const double kr = wide ? 0.2722287 : 0.2126, kb = wide ? 0.0536895 : 0.0722;
        const double r = 0.7, g = 0.4, b = 0.2, y = kr * r + (1 - kr - kb) * g + kb * b;
        sky.fill("Y", float(y)).fill("RY", float((r - y) / y)).fill("BY", float((b - y) / y));
        if (wide) Imf::addChromaticities(sky.header, acescg());
        const std::array<double, 3> wanted =
            wide ? std::array{1.70505 * r - 0.62179 * g - 0.08326 * b,
                              -0.13026 * r + 1.1408 * g - 0.01055 * b, -0.024 * r - 0.12897 * g + 1.15297 * b}
                 : std::array{r, g, b};
        expectColor(load(sky), wanted, 1e-4);
    }
    ExrSky without(boxOf(0, 0, 2, 1));
    without.fill("Y", 1).fill("RY", 0);
    EXPECT_THAT(errorOf([&] { load(without); }).what(), HasSubstr("no channel 'BY'"));
}

TEST_F(ExrEnvironment, OfHalvesTakesTheirLargestForInfinity) {
    ExrSky sky(boxOf(0, 0, 2, 1));
    sky.type = Imf::HALF;
    sky.channels = {{"R", {HUGE_VALF, 3}}, {"G", {2, 3}}, {"B", {2, 3}}};
    const Scene scene = load(sky);
    EXPECT_EQ(texel(scene, 0, 0), (std::array{65504.0f, 2.0f, 2.0f}));
    EXPECT_EQ(texel(scene, 1, 0), (std::array{3.0f, 3.0f, 3.0f}));
    EXPECT_THAT(noteOf(scene), HasSubstr("1 have an infinite channel"));
}

TEST_F(ExrEnvironment, OfOblongPixelsSaysThatItIsStretched) {
    ExrSky sky(boxOf(0, 0, 2, 1));
    sky.fill("Y", 1).header.pixelAspectRatio() = 2;
    EXPECT_THAT(noteOf(load(sky)), HasSubstr("4 times as wide as high"));
    ExrSky square(boxOf(0, 0, 2, 2));
    square.fill("Y", 1).header.pixelAspectRatio() = 2;
    EXPECT_TRUE(load(square).warnings.empty()) << "it is twice as wide as high";
}

TEST_F(ExrEnvironment, OfPrimariesThatMakeNoColoursIsRefused) {
    ExrSky sky(boxOf(0, 0, 2, 1));
    sky.fill("R", 1).fill("G", 0).fill("B", 0);
    Imf::addChromaticities(sky.header,
                           Imf::Chromaticities({0.3f, 0.3f}, {0.3f, 0.3f}, {0.3f, 0.3f}, {0.3f, 0.3f}));
    EXPECT_THAT(errorOf([&] { load(sky); }).what(), HasSubstr("make no colours"));
}

struct SharedEnvironment : ExrEnvironment {
    static Scene loadCase(const char* file) { return load(fs::path(TILEFARM_SHARED_DATA) / "cases" / file); }
    void SetUp() override {
        if (!fs::exists(fs::path(TILEFARM_SHARED_DATA) / "cases/hdr-exposure"))
            GTEST_SKIP() << "no shared data";
    }
};

TEST_F(SharedEnvironment, ShowsWhatTheCasesSay) {
    const Scene inside = loadCase("exr-data-window-inside/e.exr");
    ASSERT_EQ(inside.environment.image.width, 32u);
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 32; ++x)
            EXPECT_EQ(texel(inside, x, y)[2], x >= 8 && x < 24 && y >= 4 && y < 12 ? 0.5f : 0.0f)
                << x << " " << y;

    expectColor(loadCase("env-negative-channel/e.exr"), {0, 0.5, 1}, 0);

    const Scene cube = loadCase("exr-envmap-cube/e.exr");  // +x is white, all else black
    const uint32_t width = cube.environment.image.width, height = cube.environment.image.height;
    EXPECT_EQ(texel(cube, width / 2, height / 2)[0], 1);
    for (const uint32_t x : {0u, width / 4, 3 * width / 4}) EXPECT_EQ(texel(cube, x, height / 2)[0], 0);
    double solidAngle = 0;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            solidAngle += double{texel(cube, x, y)[1]} * std::sin((y + 0.5) / height * glm::pi<double>());
    EXPECT_NEAR(solidAngle * glm::pi<double>() * glm::two_pi<double>() / (double(width) * height),
                glm::two_pi<double>() / 3, 2e-3);

    // Texel (0, 0) is (0.2, 0.1, 0.5) of ACEScg.
    const auto wide = texel(loadCase("exr-chromaticities-ap1/e.exr"), 0, 0);
    EXPECT_NEAR(wide[0], 1.70505 * 0.2 - 0.62179 * 0.1 - 0.08326 * 0.5, 1e-5);
    EXPECT_NEAR(wide[1], -0.13026 * 0.2 + 1.1408 * 0.1 - 0.01055 * 0.5, 1e-5);
    EXPECT_NEAR(wide[2], -0.024 * 0.2 - 0.12897 * 0.1 + 1.15297 * 0.5, 1e-5);

    // Two exposures of 0.5 over (0.25, 0.5, 1).
    const Scene exposed = loadCase("hdr-exposure/e.hdr");
    EXPECT_EQ(texel(exposed, 0, 0), (std::array{1.0f, 2.0f, 4.0f}));
    EXPECT_TRUE(exposed.warnings.empty());
}

}  // namespace
}  // namespace tilefarm
