#include "shared/job/bundle_paths.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "shared/error/error.h"
#include "shared/job/safe_path.h"

namespace tilefarm {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 10> kSceneFiles{".png", ".jpg",  ".jpeg", ".webp", ".avif",
                                                       ".dds", ".ktx2", ".ktx",  ".bin",  ".hdr"};

}  // namespace

std::string TidyPath::text() const {
    std::string text;
    for (size_t i = 0; i < levelsUp; ++i) text += "../";
    return text + rest;
}

TidyPath tidyPath(std::string_view path) {
    TidyPath tidy;
    if (path.starts_with('/')) tidy.rest = "/";
    std::vector<std::string_view> segments;
    while (!path.empty()) {
        const std::string_view segment = path.substr(0, path.find('/'));
        path.remove_prefix(std::min(segment.size() + 1, path.size()));
        if (segment.empty() || segment == ".") continue;
        if (segment != "..")
            segments.push_back(segment);
        else if (segments.empty())
            ++tidy.levelsUp;
        else
            segments.pop_back();
    }
    for (size_t i = 0; i < segments.size(); ++i) tidy.rest += (i > 0 ? "/" : "") + std::string(segments[i]);
    return tidy;
}

std::string referenceFault(const TidyPath& path) {
    if (std::string fault = pathFault(path.rest); !fault.empty()) return fault;
    const auto named = [&](std::string_view suffix) { return hasSuffix(path.rest, suffix); };
    if (path.levelsUp > 0 && std::none_of(kSceneFiles.begin(), kSceneFiles.end(), named))
        return "lies above the scene's folder and is neither an image nor a .bin";
    return {};
}

BundleRoot::BundleRoot(const fs::path& entry, size_t levelsUp) : entry_(entry.filename().string()) {
    root_ = entry.parent_path();
    if (levelsUp == 0) return;
    root_ = fs::absolute(entry).lexically_normal().parent_path();
    for (size_t i = 0; i < levelsUp; ++i) {
        if (!root_.has_relative_path())
            throw Error(ErrorCode::invalidArgument,
                        fmt::format("{}: refers to files {} folders up, which is above all folders",
                                    entry.string(), levelsUp));
        folder_.insert(0, root_.filename().string() + "/");
        root_ = root_.parent_path();
    }
    entry_.insert(0, folder_);
}

std::string BundleRoot::nameOf(const TidyPath& path) const {
    return tidyPath(folder_ + path.text()).text();
}

size_t levelsAbove(std::string_view entry) {
    return static_cast<size_t>(std::count(entry.begin(), entry.end(), '/'));
}

}  // namespace tilefarm
