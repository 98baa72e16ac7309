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

std::filesystem::path numbered(const std::filesystem::path& path, int32_t frame) {
    const std::string name = path.filename().string();
    if (const size_t first = name.find('#'); first != std::string::npos) {
        const size_t end = std::min(name.find_first_not_of('#', first), name.size());
        return path.parent_path() /
               (name.substr(0, first) + fmt::format("{:0{}}", frame, end - first) + name.substr(end));
    }
    return path.parent_path() /
           fmt::format("{}.{:04}{}", path.stem().string(), frame, path.extension().string());
}

void downloadFrame(FarmClient& farm, const std::string& id, int32_t frame, const PictureOptions& pictures,
                   const Console& console) {
    const std::string image = fmt::format("/v1/jobs/{}/frames/{}/image", percentEncoded(id), frame);
    if (!pictures.exr.empty()) fetch(farm, image + ".exr", pictures.exr, console);
    if (!pictures.png.empty())
        fetch(farm,
              fmt::format("{}.png?exposure={}&tone={}", image, pictures.tone.exposure,
                          toString(pictures.tone.curve)),
              pictures.png, console);
}

int download(FarmClient& farm, const std::string& id, std::optional<int32_t> frame,
             const PictureOptions& pictures, const Console& console) {
    if (!frame) frame = farm.job(id).at("spec").at("frames").at("first").get<int32_t>();
    downloadFrame(farm, id, *frame, pictures, console);
    return kDone;
}

}  // namespace tilefarm
