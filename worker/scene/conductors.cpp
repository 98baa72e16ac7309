// Published measurements, interpolated linearly in wavelength to 630, 532 and 465 nm from the points next to
// them as refractiveindex.info lists them:
//   J&C72     Johnson, Christy: Optical constants of the noble metals. Phys. Rev. B 6, 4370 (1972)
//   J&C74     Johnson, Christy: Optical constants of transition metals. Phys. Rev. B 9, 5056 (1974)
//   Rakić 95  Rakić: Algorithm for the determination of intrinsic optical constants of metal films:
//             application to aluminum. Appl. Opt. 34, 4755 (1995)
//   Rakić 98  Rakić, Djurišić, Elazar, Majewski: Optical properties of metallic films for vertical-cavity
//             optoelectronic devices. Appl. Opt. 37, 5271 (1998), Brendel-Bormann fit
//   Weaver    Weaver, Olson, Lynch: Optical properties of crystalline tungsten. Phys. Rev. B 12, 1293 (1975)
//   Werner    Werner, Glantschnig, Ambrosch-Draxl: Optical constants and inelastic electron-scattering data
//             for 17 elemental metals. J. Phys. Chem. Ref. Data 38, 1013 (2009)
//   Querry    Querry: Optical constants. CRDC-CR-85034 (1985); 70 % copper, 30 % zinc
// Three wavelengths stand for three bands; a spectral renderer differs where n and k change fast within one
// (gold and copper in green).
#include "worker/scene/conductors.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace tilefarm {
namespace {

struct Entry {
    std::string_view name, synonym;
    Conductor metal;
};

constexpr size_t kMetals = 14;

const std::array<Entry, kMetals>& table() {
    static const std::array<Entry, kMetals> entries{{
        {"gold", "au", {{0.188f, 0.544f, 1.332f}, {3.403f, 2.231f, 1.869f}}},             // J&C72
        {"silver", "ag", {{0.057f, 0.054f, 0.047f}, {4.254f, 3.429f, 2.803f}}},           // J&C72
        {"copper", "cu", {{0.275f, 1.116f, 1.247f}, {3.373f, 2.596f, 2.456f}}},           // J&C72
        {"aluminium", "aluminum", {{1.430f, 0.939f, 0.686f}, {7.508f, 6.420f, 5.635f}}},  // Rakić 95
        {"iron", "fe", {{2.892f, 2.895f, 2.646f}, {3.065f, 2.918f, 2.805f}}},             // J&C74
        {"chromium", "chrome", {{3.145f, 3.034f, 2.456f}, {3.312f, 3.330f, 3.210f}}},     // J&C74
        {"nickel", "ni", {{1.990f, 1.877f, 1.765f}, {4.094f, 3.495f, 3.048f}}},           // J&C74
        {"titanium", "ti", {{2.698f, 2.479f, 2.305f}, {3.757f, 3.351f, 3.082f}}},         // J&C74
        {"palladium", "pd", {{1.765f, 1.597f, 1.445f}, {4.275f, 3.743f, 3.351f}}},        // J&C74
        {"cobalt", "co", {{2.209f, 2.001f, 1.789f}, {4.160f, 3.735f, 3.371f}}},           // J&C74
        {"platinum", "pt", {{2.314f, 2.038f, 1.879f}, {4.160f, 3.612f, 3.223f}}},         // Rakić 98
        {"tungsten", "wolfram", {{3.617f, 3.495f, 3.325f}, {2.910f, 2.718f, 2.574f}}},    // Weaver
        {"zinc", "zn", {{1.169f, 0.882f, 0.713f}, {5.699f, 4.805f, 4.160f}}},             // Werner
        {"brass", "cu70zn30", {{0.445f, 0.568f, 0.947f}, {3.522f, 2.588f, 1.920f}}},      // Querry
    }};
    return entries;
}

}  // namespace

std::optional<Conductor> conductorNamed(std::string_view name) {
    std::string lower(name);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const Entry& entry : table())
        if (lower == entry.name || lower == entry.synonym) return entry.metal;
    return std::nullopt;
}

std::vector<std::string_view> conductorNames() {
    std::vector<std::string_view> names;
    for (const Entry& entry : table()) names.push_back(entry.name);
    return names;
}

}  // namespace tilefarm
