#include "shared/film/layout.h"

#include <fmt/format.h>

#include "shared/job/job.h"

namespace tilefarm {
namespace {

constexpr std::array<std::string_view, FilmLayout::kLightPaths> kPathNames{
    "emission",          "diffuse_direct",      "diffuse_indirect",      "specular_direct",
    "specular_indirect", "transmission_direct", "transmission_indirect", "volume_direct",
    "volume_indirect"};

}  // namespace

std::vector<std::string> FilmLayout::channels() const {
    std::vector<std::string> names;
    if (lightPaths)
        for (const std::string_view path : kPathNames)
            for (const char c : {'R', 'G', 'B'}) names.push_back(fmt::format("{}.{}", path, c));
    if (uv) names.insert(names.end(), {"uv.U", "uv.V"});
    if (cryptomatte)
        for (const std::string_view matte : kMattes)
            for (uint32_t i = 0; i < 2 * kMatteRanks; ++i)
                names.push_back(fmt::format("{}{:02}.{}", matte, i / 4, "RGBA"[i % 4]));
    return names;
}

std::string FilmLayout::text() const {
    std::string text;
    for (const auto& [has, name] :
         {std::pair{lightPaths, "lightPaths"}, {uv, "uv"}, {cryptomatte, "cryptomatte"}})
        if (has) text += (text.empty() ? "" : ", ") + std::string(name);
    return text.empty() ? "none" : text;
}

std::vector<FilmLayout> FilmLayout::all() {
    std::vector<FilmLayout> layouts;
    for (uint32_t bits = 0; bits < 8; ++bits)
        layouts.push_back(
            {.lightPaths = (bits & 1) != 0, .uv = (bits & 2) != 0, .cryptomatte = (bits & 4) != 0});
    return layouts;
}

FilmLayout filmLayoutOf(const JobSpec& spec) {
    const OutputSettings& output = spec.output;
    return {.lightPaths = output.lightPaths, .uv = output.uv, .cryptomatte = output.cryptomatte};
}

}  // namespace tilefarm
