#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "shared/job/output.h"

namespace tilefarm {

/// Cryptomatte 1.2 (Friedman, Jones 2015; Psyop's specification): ids are hashes of names, stored as floats,
/// and a manifest in the file's header says which names they are.

/// MurmurHash3_x86_32 (Appleby 2011).
uint32_t murmur3(std::string_view text, uint32_t seed = 0);

/// Bits of the float that is the id of a name: its hash, one exponent bit flipped where the float would be a
/// NaN, infinite, zero or denormal.
uint32_t matteId(std::string_view name);
/// Eight lower-case hex digits, as manifests have it.
std::string matteHex(uint32_t id);

/// What says which names ids are.
struct MatteMetadata {
    /// Header entries of a layer: `cryptomatte/<7 digits>/` name, hash, conversion, and manifest or
    /// manif_file.
    std::map<std::string, std::string> header;
    /// Files to lie beside the picture, by their names, which follow from what is in them.
    std::map<std::string, std::string> sidecars;
    void add(MatteMetadata other);
};
MatteMetadata matteMetadata(std::string_view layer, const std::set<std::string>& names,
                            MatteManifest place = MatteManifest::automatic);

/// The sidecars that a header names, as far as they are names of ours.
std::vector<std::string> sidecarsNamedIn(const std::map<std::string, std::string>& header);

}  // namespace tilefarm
