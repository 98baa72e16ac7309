#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "server/cli/commands.h"
#include "shared/denoise/exr_denoise.h"
#include "shared/image/exr.h"
#include "shared/matte/cryptomatte.h"

namespace tilefarm {

namespace {

// Files of ours hold the job that made them.
bool isPanorama(const std::filesystem::path& exr) {
    const ImageAttributes attributes = readExrAttributes(exr);
    const auto settings = attributes.find("settings");
    if (settings == attributes.end()) return false;
    const auto job = nlohmann::json::parse(settings->second, nullptr, false);
    const auto kind = nlohmann::json::json_pointer("/view/kind");
    return job.is_object() && job.contains(kind) && job.at(kind) == "panorama";
}

void copyManifests(const std::filesystem::path& in, const std::filesystem::path& out) {
    for (const std::string& name : sidecarsNamedIn(readExrMetadata(in))) {
        const std::filesystem::path from = in.parent_path() / name, to = out.parent_path() / name;
        if (exists(from) && !exists(to)) copy_file(from, to);
    }
}

}  // namespace

int denoiseFile(const std::filesystem::path& in, const std::filesystem::path& out, bool wrap,
                const Console& console) {
    denoiseExr(in, out, {.wrap = wrap || isPanorama(in)});
    copyManifests(in, out);
    console.err << fmt::format("wrote {}\n", out.string());
    return kDone;
}

}  // namespace tilefarm
