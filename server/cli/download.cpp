#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "server/cli/commands.h"
#include "shared/farm_client/http_status.h"
#include "shared/image/exr.h"
#include "shared/matte/cryptomatte.h"

namespace tilefarm {

namespace {

void fetch(FarmClient& farm, const std::string& path, const std::filesystem::path& file,
           const Console& console) {
    farm.download(path, file);
    console.err << fmt::format("wrote {}\n", file.string());
}

// An EXR names the manifests of its mattes by what is in them, so that one is there already if it is there.
void fetchManifests(FarmClient& farm, const std::string& id, const std::filesystem::path& exr,
                    const Console& console) {
    for (const std::string& name : sidecarsNamedIn(readExrMetadata(exr))) {
        const std::filesystem::path file = exr.parent_path() / name;
        if (!exists(file))
            fetch(farm, fmt::format("/v1/jobs/{}/mattes/{}", percentEncoded(id), percentEncoded(name)), file,
                  console);
    }
}

bool hasMattes(FarmClient& farm, const std::string& id) {
    return farm.job(id).at("spec").value(nlohmann::json::json_pointer("/output/cryptomatte"), false);
}

}  // namespace

void downloadFrame(FarmClient& farm, const std::string& id, int32_t frame, const PictureOptions& pictures,
                   const Console& console) {
    const std::string image = fmt::format("/v1/jobs/{}/frames/{}/image", percentEncoded(id), frame);
    if (!pictures.exr.empty()) {
        fetch(farm, image + ".exr", pictures.exr, console);
        if (hasMattes(farm, id)) fetchManifests(farm, id, pictures.exr, console);
    }
    if (!pictures.png.empty())
        fetch(farm,
              fmt::format("{}.png?exposure={}&tone={}{}", image, pictures.tone.exposure,
                          toString(pictures.tone.curve), pictures.denoised ? "&denoised=1" : ""),
              pictures.png, console);
}

int download(FarmClient& farm, const std::string& id, std::optional<int32_t> frame,
             const PictureOptions& pictures, const Console& console) {
    if (!frame) frame = farm.job(id).at("spec").at("frames").at("first").get<int32_t>();
    downloadFrame(farm, id, *frame, pictures, console);
    return kDone;
}

}  // namespace tilefarm
