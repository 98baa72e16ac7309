// Several frames of a job: numbered files, a zip of EXRs, a movie.
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <zip.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <vector>

#include "server/cli/commands.h"
#include "shared/error/error.h"
#include "shared/job/frames.h"
#include "shared/job/safe_path.h"

extern char** environ;

namespace fs = std::filesystem;

namespace tilefarm {

namespace {

/// Pictures on their way into one file. Gone at the end.
class WorkFolder {
public:
    WorkFolder() {
        std::string name = (fs::temp_directory_path() / "tilefarm-frames-XXXXXX").string();
        if (!mkdtemp(name.data()))
            throw Error(ErrorCode::internal,
                        fmt::format("cannot make a folder like {}: {}", name, std::strerror(errno)));
        path_ = name;
    }
    ~WorkFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;
    fs::path operator/(const std::string& name) const { return path_ / name; }

private:
    fs::path path_;
};

nlohmann::json specOf(FarmClient& farm, const std::string& id) {
    return farm.job(id).at("spec");
}

std::vector<fs::path> filesIn(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

[[noreturn]] void failZip(const fs::path& file, const char* why) {
    throw Error(ErrorCode::internal, fmt::format("cannot write {}: {}", file.string(), why));
}

// Not compressed: EXRs are already.
void writeZip(const fs::path& file, const std::vector<fs::path>& members) {
    int code = 0;
    zip_t* archive = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code);
    if (!archive) {
        zip_error_t error;
        zip_error_init_with_code(&error, code);
        const std::string why = zip_error_strerror(&error);
        zip_error_fini(&error);
        failZip(file, why.c_str());
    }
    std::unique_ptr<zip_t, decltype(&zip_discard)> discard(archive, zip_discard);
    for (const fs::path& member : members) {
        zip_source_t* source = zip_source_file(archive, member.c_str(), 0, -1);
        const zip_int64_t index = zip_file_add(archive, member.filename().c_str(), source, ZIP_FL_ENC_UTF_8);
        if (index < 0) {
            zip_source_free(source);
            failZip(file, zip_strerror(archive));
        }
        if (zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), ZIP_CM_STORE, 0) != 0)
            failZip(file, zip_strerror(archive));
    }
    if (zip_close(archive) != 0) failZip(file, zip_strerror(archive));
    static_cast<void>(discard.release());  // closed
}

int run(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t child = 0;
    if (const int fault = posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), environ))
        throw Error(
            ErrorCode::notFound,
            fmt::format("cannot start {}: {}. It makes the movie; Debian has it in the package ffmpeg",
                        words[0], std::strerror(fault)));
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

}  // namespace

FrameSet framesOf(const nlohmann::json& spec) {
    const nlohmann::json& frames = spec.at("frames");
    return {frames.at("first").get<int32_t>(), frames.at("count").get<uint32_t>(), frames.value("step", 1u),
            frames.value("list", "")};
}

int downloadFrames(FarmClient& farm, const std::string& id, const std::string& which, const fs::path& output,
                   const PictureOptions& like, const Console& console) {
    const std::vector<int32_t> frames =
        sortedFrameNumbers(which == "all" ? framesOf(specOf(farm, id)) : framesFrom(which));
    const bool zip = hasSuffix(output.string(), ".zip");
    const WorkFolder folder;
    for (const int32_t frame : frames) {
        const fs::path file = zip ? folder / numbered("frame.exr", frame).string() : numbered(output, frame);
        const bool exr = hasSuffix(file.string(), ".exr");
        downloadFrame(farm, id, frame, {exr ? file : "", exr ? "" : file, like.tone, like.denoised}, console);
    }
    if (!zip) return kDone;
    writeZip(output, filesIn(folder / ""));
    console.err << fmt::format("wrote {}: {} frames\n", output.string(), frames.size());
    return kDone;
}

int makeMovie(FarmClient& farm, const std::string& id, const fs::path& output, double fps,
              const PictureOptions& like, const Console& console) {
    const nlohmann::json spec = specOf(farm, id);
    const std::vector<int32_t> frames = sortedFrameNumbers(framesOf(spec));
    if (fps <= 0) fps = spec.at("motion").at("fps").get<double>();
    const WorkFolder folder;
    for (size_t i = 0; i < frames.size(); ++i)
        downloadFrame(farm, id, frames[i],
                      {{}, folder / fmt::format("{:06}.png", i), like.tone, like.denoised}, console);
    // Players want even sizes and 4:2:0; the last row or column is repeated for that.
    const int code = run({"ffmpeg", "-v", "error", "-nostdin", "-y", "-framerate", fmt::format("{}", fps),
                          "-i", (folder / "%06d.png").string(), "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                          "-pix_fmt", "yuv420p", "-crf", "18", output.string()});
    if (code != 0)
        throw Error(ErrorCode::internal,
                    fmt::format("ffmpeg ended with {} and made no {}", code, output.string()));
    console.err << fmt::format("wrote {}: {} frames at {} a second\n", output.string(), frames.size(), fps);
    return kDone;
}

}  // namespace tilefarm
