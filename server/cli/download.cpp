#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "server/cli/commands.h"
#include "shared/farm_client/http_status.h"

namespace tilefarm {

namespace {

void fetch(FarmClient& farm, const std::string& path, const std::filesystem::path& file,
           const Console& console) {
    farm.download(path, file);
    console.err << fmt::format("wrote {}\n", file.string());
}

}  // namespace

void downloadFrame(FarmClient& farm, const std::string& id, int32_t frame, const PictureOptions& pictures,
                   const Console& console) {
    const std::string image = fmt::format("/v1/jobs/{}/frames/{}/image", percentEncoded(id), frame);
    if (!pictures.exr.empty()) fetch(farm, image + ".exr", pictures.exr, console);
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
