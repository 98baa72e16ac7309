// Mutates glTF files and environments: whatever comes, the loader gives a scene or an Error, never a crash, a
// hang or an index out of range. Seeds are fixed; TILEFARM_FUZZ_ROUNDS raises the number of rounds.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "shared/error/error.h"
#include "tests/fuzz/gltf_container.h"
#include "tests/fuzz/gltf_words.h"
#include "tests/fuzz/scene_seeds.h"
#include "tests/support/temporary_folder.h"
#include "worker/scene/gltf_file.h"
#include "worker/scene/gltf_source.h"
#include "worker/scene/load.h"
#include "worker/scene/world.h"

namespace tilefarm {
namespace {

int rounds(int usual) {
    const char* text = std::getenv("TILEFARM_FUZZ_ROUNDS");
    return text ? std::atoi(text) : usual;
}

void mutate(std::vector<std::byte>& bytes, std::mt19937& random) {
    const auto below = [&](size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random); };
    constexpr std::string_view tokens[] = {
        "-1",   "0",  "1", "2", "3", "0.5", "255", "5121", "1e300", "4294967295", "99999999999999999999",
        "null", "[]", "{}"};
    const auto isDigit = [](std::byte b) { return std::isdigit(std::to_integer<unsigned char>(b)) != 0; };
    for (size_t i = 0, n = 1 + below(8) / 6; i < n && !bytes.empty(); ++i) {
        const size_t at = below(bytes.size());
        const auto place = bytes.begin() + ptrdiff_t(at);
        switch (below(12)) {
            case 0: *place ^= static_cast<std::byte>(1u << below(8)); break;
            case 1: *place = static_cast<std::byte>(below(256)); break;
            case 2: bytes.insert(place, bytes[below(bytes.size())]); break;
            case 3: bytes.resize(at); break;
            default: {  // a number becomes another
                const auto first = std::find_if(place, bytes.end(), isDigit);
                const auto last = std::find_if_not(first, bytes.end(), isDigit);
                const auto token = std::as_bytes(std::span(tokens[below(std::size(tokens))]));
                bytes.insert(bytes.erase(first, last), token.begin(), token.end());
            }
        }
    }
}

void expectSound(const Scene& scene) {
    ASSERT_FALSE(scene.materials.empty());
    for (const Mesh& mesh : scene.meshes) {
        ASSERT_LT(mesh.material, scene.materials.size());
        for (glm::uvec3 t : mesh.triangles) {
            ASSERT_LT(std::max({t.x, t.y, t.z}), mesh.positions.size());
        }
    }
    const WorldGeometry world = flatten(scene);
    for (glm::vec3 corner : world.corners()) {
        ASSERT_TRUE(std::isfinite(corner.x) && std::isfinite(corner.y) && std::isfinite(corner.z));
    }
    for (glm::vec3 normal : world.normals) {
        ASSERT_LE(glm::length(normal), 1.001f);
    }
    selectCamera(scene, "auto", 1.5);
}

void loadMutated(const std::filesystem::path& path, int& loaded) {
    try {
        GltfSource source(path, {});
        expectSound(source.at(0));
        if (source.animated()) expectSound(source.at(source.seconds() / 2));
        ++loaded;
    } catch (const Error& error) {
        ASSERT_EQ(error.code, ErrorCode::invalidArgument) << error.what();
    }
}

std::vector<std::filesystem::path> writtenSeeds(const TemporaryFolder& folder) {
    writeBytes(folder / "a.png", encodePng(1, 1, 3, 8, {1, 2, 3}));  // that one of them names
    return writeSceneSeeds(folder.path());
}

TEST(SceneFuzz, SeedsAreWholeFiles) {
    TemporaryFolder folder;
    for (const auto& path : writtenSeeds(folder)) {
        SCOPED_TRACE(path.filename());
        GltfSource source(path, {});
        for (const double time : {0.0, 0.5, 1.0}) ASSERT_NO_FATAL_FAILURE(expectSound(source.at(time)));
        // Small ones: the fuzzers try thousands a second.
        EXPECT_LT(std::filesystem::file_size(path), 8000u);
    }
}

TEST(SceneFuzz, MutatedFilesGiveASceneOrAnError) {
    TemporaryFolder folder;
    for (const auto& path : writtenSeeds(folder)) {
        SCOPED_TRACE(path.filename());
        const auto seed = readFileBytes(path);
        int loaded = 0;
        for (int round = 0; round < rounds(80); ++round) {
            std::mt19937 random(static_cast<uint32_t>(round));
            std::vector<std::byte> bytes = seed;
            mutate(bytes, random);
            writeBytes(folder / "mutated.gltf", bytes);
            SCOPED_TRACE(round);
            ASSERT_NO_FATAL_FAILURE(loadMutated(folder / "mutated.gltf", loaded));
        }
        EXPECT_GT(loaded, rounds(80) / 40) << "mutations so wild that nothing past the parser is reached";
    }
}

TEST(SceneFuzz, FilesMutatedAsJsonGiveASceneOrAnError) {
    TemporaryFolder folder;
    for (const auto& path : writtenSeeds(folder)) {
        SCOPED_TRACE(path.filename());
        const auto seed = fuzz::GltfContainer::parse(readFileBytes(path));
        int loaded = 0;
        for (int round = 0; round < rounds(80); ++round) {
            fuzz::JsonMutator random(static_cast<uint32_t>(round), fuzz::kGltfWords);
            fuzz::GltfContainer file = *seed;
            random.mutate(file.json);
            writeBytes(folder / "mutated.gltf", file.bytes());
            SCOPED_TRACE(round);
            ASSERT_NO_FATAL_FAILURE(loadMutated(folder / "mutated.gltf", loaded));
        }
        EXPECT_GT(loaded, rounds(80) / 40);
    }
}

TEST(SceneFuzz, MutatedEnvironmentsGiveAPictureOrAnError) {
    TemporaryFolder folder;
    std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 16\n";
    for (int row = 0; row < 4; ++row) {
        text += std::string("\x02\x02\x00\x10", 4);
        for (int channel = 0; channel < 4; ++channel) {
            text += "\x90\x81";  // a run of 16
        }
    }
    const auto seed = std::as_bytes(std::span(text));
    for (int round = 0; round < rounds(400); ++round) {
        std::mt19937 random(static_cast<uint32_t>(round));
        std::vector<std::byte> bytes(seed.begin(), seed.end());
        mutate(bytes, random);
        writeBytes(folder / "sky.hdr", bytes);
        Scene scene;
        try {
            loadEnvironment(scene, folder / "sky.hdr");
            for (float value : scene.environment.image.rgbaFloat) {
                ASSERT_TRUE(std::isfinite(value) && value >= 0) << round;
            }
        } catch (const Error& error) {
            ASSERT_EQ(error.code, ErrorCode::invalidArgument) << error.what();
        }
    }
}

}  // namespace
}  // namespace tilefarm
