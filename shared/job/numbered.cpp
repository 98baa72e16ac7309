#include "shared/job/numbered.h"

#include <fmt/format.h>

#include <algorithm>

namespace tilefarm {

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

}  // namespace tilefarm
