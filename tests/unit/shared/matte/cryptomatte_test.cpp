#include "shared/matte/cryptomatte.h"
#include "shared/job/job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "shared/matte/scene_names.h"
#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::Pair;

TEST(Murmur3, GivesThePublishedVectors) {
    EXPECT_EQ(murmur3("", 0), 0u);
    EXPECT_EQ(murmur3("", 1), 0x514e28b7u);
    EXPECT_EQ(murmur3("", 0xffffffff), 0x81f16f39u);
    EXPECT_EQ(murmur3("test", 0), 0xba6bd213u);
    EXPECT_EQ(murmur3("test", 0x9747b28c), 0x704b81dcu);
    EXPECT_EQ(murmur3("Hello, world!", 0), 0xc0363e43u);
    EXPECT_EQ(murmur3("Hello, world!", 0x9747b28c), 0x24884cbau);
    EXPECT_EQ(murmur3("The quick brown fox jumps over the lazy dog", 0), 0x2e4ff723u);
    EXPECT_EQ(murmur3("a", 0x9747b28c), 0x7fa09ea6u);
    EXPECT_EQ(murmur3("aa", 0x9747b28c), 0x5d211726u);
    EXPECT_EQ(murmur3("aaa", 0x9747b28c), 0x283e0130u);
}

TEST(MatteId, IsAFloatThatSurvivesProcessing) {
    int flipped = 0;
    for (int i = 0; i < 20000; ++i) {
        const std::string name = "object" + std::to_string(i);
        const uint32_t id = matteId(name), hash = murmur3(name);
        EXPECT_TRUE(std::isnormal(std::bit_cast<float>(id))) << name;
        EXPECT_EQ(id & ~(1u << 23), hash & ~(1u << 23)) << name;
        flipped += id != hash;
    }
    EXPECT_GT(flipped, 100);  // 2 of 256 exponents: 156 are expected
    EXPECT_LT(flipped, 220);
}

// As in Psyop's sample images, whose layers have these names.
TEST(MatteMetadata, HasTheKeysOfPublishedLayers) {
    EXPECT_EQ(matteHex(matteId("crypto_object")).substr(0, 7), "f834d0a");
    EXPECT_EQ(matteHex(matteId("crypto_material")).substr(0, 7), "bda530a");
    EXPECT_EQ(matteHex(matteId("uCryptoAsset")).substr(0, 7), "d593dd7");
    EXPECT_EQ(matteHex(matteId("bunny")), "13851a76");
}

TEST(MatteMetadata, NamesLayerHashConversionAndManifest) {
    const auto metadata = matteMetadata("CryptoObject", {"a \"quoted\" name", "Stuhl – grün"});
    EXPECT_TRUE(metadata.sidecars.empty());
    EXPECT_THAT(metadata.header, ElementsAre(Pair("cryptomatte/3ae39a5/conversion", "uint32_to_float32"),
                                             Pair("cryptomatte/3ae39a5/hash", "MurmurHash3_32"),
                                             Pair("cryptomatte/3ae39a5/manifest", testing::_),
                                             Pair("cryptomatte/3ae39a5/name", "CryptoObject")));
    const json manifest = json::parse(metadata.header.at("cryptomatte/3ae39a5/manifest"));
    ASSERT_EQ(manifest.size(), 2u);
    for (const auto& [name, hex] : manifest.items()) EXPECT_EQ(hex, matteHex(matteId(name)));
}

// Lengths around the longest that a header holds: {"a":"01234567"} is 15 bytes longer than its name.
TEST(MatteMetadata, PutsLongManifestsBesideThePicture) {
    for (const size_t length : {1u, 235u, 236u, 237u, 5000u}) {
        const std::set<std::string> names{std::string(length, 'n')};
        const MatteMetadata usual = matteMetadata("CryptoObject", names),
                            sidecar = matteMetadata("CryptoObject", names, MatteManifest::sidecar),
                            header = matteMetadata("CryptoObject", names, MatteManifest::header);
        const std::string& text = header.header.at("cryptomatte/3ae39a5/manifest");
        EXPECT_TRUE(header.sidecars.empty());
        ASSERT_EQ(sidecar.sidecars.size(), 1u);
        const auto& [file, same] = *sidecar.sidecars.begin();
        EXPECT_EQ(same, text);
        EXPECT_EQ(sidecar.header.at("cryptomatte/3ae39a5/manif_file"), file);
        EXPECT_FALSE(sidecar.header.contains("cryptomatte/3ae39a5/manifest"));
        EXPECT_THAT(sidecarsNamedIn(sidecar.header), ElementsAre(file));
        EXPECT_EQ(usual.header, text.size() > 250 ? sidecar.header : header.header) << text.size();
    }
}

TEST(MatteMetadata, FollowsNoNameOutOfTheFolder) {
    for (const char* name :
         {"../CryptoObject.json", "Crypto/../../x.json", "/etc/passwd", "CryptoObject.exr", "x.json", ""})
        EXPECT_TRUE(sidecarsNamedIn({{"cryptomatte/3ae39a5/manif_file", name}}).empty()) << name;
}

GltfBytes bytesOf(const std::string& text) {
    return {text.size(), [&text](uint64_t offset, std::span<std::byte> into) {
                ASSERT_LE(offset + into.size(), text.size());
                std::memcpy(into.data(), text.data() + offset, into.size());
            }};
}

const std::string kGltf = R"({"asset": {"version": "2.0"},
    "nodes": [{"name": "Table", "children": [1]}, {"mesh": 0, "extras": {"name": "no"}}, {"name": "Table"}, {"name": "Lampe ü"}],
    "materials": [{"name": "Oak"}, {"doubleSided": true}],
    "meshes": [{"name": "not an object", "primitives": []}],
    "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "name": "Bulb"}, {"type": "spot"}]}, "X": {"name": "no"}}})";

std::string glbOf(const std::string& text) {
    const auto word = [](size_t value) {
        const auto v = static_cast<uint32_t>(value);
        return std::string(reinterpret_cast<const char*>(&v), 4);
    };
    return "glTF" + word(2) + word(28 + text.size() + 3) + word(text.size()) + "JSON" + text + word(3) +
           std::string("BIN\0", 4) + "xyz";
}

TEST(SceneNames, AreThoseOfNodesMaterialsAndLights) {
    JobSpec job;
    job.lights.resize(2);
    job.lights[0].name = "Key";
    for (const std::string& file : {kGltf, glbOf(kGltf)}) {
        const SceneNames names = sceneNames(bytesOf(file), job);
        EXPECT_THAT(names.objects, ElementsAre("Bulb", "Key", "Lampe ü", "Table", "light", "nodes/1"));
        EXPECT_THAT(names.materials, ElementsAre("Oak", "default", "light", "materials/1"));
    }
}

TEST(SceneNames, OfFilesThatAreNoGltfAreRefusedAndLeftOutOfTheHeader) {
    JobSpec job;
    job.output.cryptomatte = true;
    for (const std::string& bad :
         std::vector<std::string>{"", "glTF", "{", "[1]", glbOf("no"), glbOf(kGltf).substr(0, 50)}) {
        EXPECT_EQ(codeOf([&] { sceneNames(bytesOf(bad), job); }), ErrorCode::invalidArgument) << bad;
        EXPECT_EQ(matteMetadata(bytesOf(bad), job).header.at("cryptomatte/be359d6/manifest"), "{}");
    }
    for (const std::string& odd : std::vector<std::string>{
             "{}", R"({"nodes": 3, "materials": {"name": "x"}, "extensions": []})",
             R"({"nodes": [1, {"name": 7}], "extensions": {"KHR_lights_punctual": []}})"})
        EXPECT_NO_THROW(sceneNames(bytesOf(odd), job)) << odd;
    job.output.cryptomatte = false;
    EXPECT_TRUE(matteMetadata(bytesOf(kGltf), job).header.empty());
}

}  // namespace
}  // namespace tilefarm
