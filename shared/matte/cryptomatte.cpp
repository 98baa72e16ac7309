#include "shared/matte/cryptomatte.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>

namespace tilefarm {
namespace {

static_assert(std::endian::native == std::endian::little, "blocks are read as little-endian words");

uint32_t scrambled(uint32_t block) {
    return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u;
}

uint32_t finished(uint32_t h) {
    h = (h ^ h >> 16) * 0x85ebca6bu;
    h = (h ^ h >> 13) * 0xc2b2ae35u;
    return h ^ h >> 16;
}

}  // namespace

uint32_t murmur3(std::string_view text, uint32_t seed) {
    uint32_t h = seed;
    std::string_view rest = text;
    for (; rest.size() >= 4; rest.remove_prefix(4)) {
        uint32_t block;
        std::memcpy(&block, rest.data(), sizeof block);
        h = std::rotl(h ^ scrambled(block), 13) * 5 + 0xe6546b64u;
    }
    uint32_t tail = 0;
    if (!rest.empty()) std::memcpy(&tail, rest.data(), rest.size());
    return finished(h ^ scrambled(tail) ^ static_cast<uint32_t>(text.size()));
}

uint32_t matteId(std::string_view name) {
    const uint32_t hash = murmur3(name), exponent = hash >> 23 & 255u;
    return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

std::string matteHex(uint32_t id) {
    return fmt::format("{:08x}", id);
}

std::map<std::string, std::string> matteMetadata(std::string_view layer, const std::set<std::string>& names) {
    nlohmann::json manifest = nlohmann::json::object();
    for (const std::string& name : names) manifest[name] = matteHex(matteId(name));
    const std::string prefix = "cryptomatte/" + matteHex(matteId(layer)).substr(0, 7) + "/";
    return {{prefix + "name", std::string(layer)},
            {prefix + "hash", "MurmurHash3_32"},
            {prefix + "conversion", "uint32_to_float32"},
            {prefix + "manifest", manifest.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)}};
}

}  // namespace tilefarm
