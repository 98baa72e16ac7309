#include "shared/matte/cryptomatte.h"

#include <fmt/format.h>
#include <murmurhash.h>

#include <nlohmann/json.hpp>

#include "shared/digest/digest.h"
#include "shared/image/exr_attributes.h"

namespace tilefarm {
namespace {

// Enough that no two scenes of a folder share a file by chance.
constexpr size_t kDigestDigits = 16;
constexpr std::string_view kSuffix = ".json";

}  // namespace

uint32_t murmur3(std::string_view text, uint32_t seed) {
    uint32_t hash = 0;
    lmmh_x86_32(text.data(), static_cast<unsigned>(text.size()), seed, &hash);
    return hash;
}

uint32_t matteId(std::string_view name) {
    const uint32_t hash = murmur3(name), exponent = hash >> 23 & 255u;
    return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

std::string matteHex(uint32_t id) {
    return fmt::format("{:08x}", id);
}

void MatteMetadata::add(MatteMetadata other) {
    header.merge(other.header);
    sidecars.merge(other.sidecars);
}

MatteMetadata matteMetadata(std::string_view layer, const std::set<std::string>& names, MatteManifest place) {
    nlohmann::json manifest = nlohmann::json::object();
    for (const std::string& name : names) manifest[name] = matteHex(matteId(name));
    const std::string text = manifest.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                      prefix = "cryptomatte/" + matteHex(matteId(layer)).substr(0, 7) + "/";
    MatteMetadata metadata{{{prefix + "name", std::string(layer)},
                            {prefix + "hash", "MurmurHash3_32"},
                            {prefix + "conversion", "uint32_to_float32"}},
                           {}};
    if (place == MatteManifest::automatic)
        place = text.size() > kMostAttributeBytes ? MatteManifest::sidecar : MatteManifest::header;
    if (place == MatteManifest::header) {
        metadata.header[prefix + "manifest"] = text;
    } else {
        const std::string file =
            fmt::format("{}-{}{}", layer, sha256Hex(text).substr(0, kDigestDigits), kSuffix);
        metadata.header[prefix + "manif_file"] = file;
        metadata.sidecars[file] = text;
    }
    return metadata;
}

std::vector<std::string> sidecarsNamedIn(const std::map<std::string, std::string>& header) {
    std::vector<std::string> files;
    for (const auto& [key, value] : header)
        if (key.starts_with("cryptomatte/") && key.ends_with("/manif_file") && value.starts_with("Crypto") &&
            value.ends_with(kSuffix) && value.find('/') == value.npos)
            files.push_back(value);
    return files;
}

}  // namespace tilefarm
