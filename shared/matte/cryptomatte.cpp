#include "shared/matte/cryptomatte.h"

#include <fmt/format.h>
#include <murmurhash.h>

#include <nlohmann/json.hpp>

namespace tilefarm {
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
