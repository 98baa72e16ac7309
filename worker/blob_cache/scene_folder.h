#pragma once

#include <filesystem>

#include "worker/blob_cache/blob_cache.h"

namespace tilefarm {

struct SceneBundle;

/// The files of a scene under their own relative names, as a loader wants them: links into the cache.
/// Lasts as long as the object; a scene is loaded whole, so that is only while it is being loaded.
class SceneFolder {
public:
    /// Fetches what is missing. Throws what BlobCache::link throws, and Error(invalidArgument) for a
    /// path that would leave the folder.
    SceneFolder(BlobCache& cache, const SceneBundle& scene, const BlobSource& source);
    ~SceneFolder();
    SceneFolder(const SceneFolder&) = delete;
    SceneFolder& operator=(const SceneFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path entry() const { return path_ / entry_; }
    /// Empty if the scene has none.
    std::filesystem::path environment() const;

private:
    void fill(BlobCache& cache, const SceneBundle& scene, const BlobSource& source);

    std::filesystem::path path_;
    std::string entry_, environment_;
};

}  // namespace tilefarm
