#include "worker/blob_cache/scene_folder.h"

#include "shared/error/error.h"
#include "shared/job/job.h"
#include "shared/job/safe_path.h"

namespace fs = std::filesystem;

namespace tilefarm {

SceneFolder::SceneFolder(BlobCache& cache, const SceneBundle& scene, const BlobSource& source)
    : path_(cache.makeSceneFolder()), entry_(scene.entry), environment_(scene.environment) {
    try {
        fill(cache, scene, source);
    } catch (...) {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
        throw;
    }
}

SceneFolder::~SceneFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

void SceneFolder::fill(BlobCache& cache, const SceneBundle& scene, const BlobSource& source) {
    for (const auto& [path, sha256] : scene.files) {
        // The wire has checked it; this is the place where a bad one would do harm.
        if (const std::string fault = pathFault(path); !fault.empty())
            throw Error(ErrorCode::invalidArgument, "scene file '" + path + "': " + fault);
        cache.link(sha256, path_ / path, source);
    }
}

fs::path SceneFolder::environment() const {
    return environment_.empty() ? fs::path() : path_ / environment_;
}

}  // namespace tilefarm
