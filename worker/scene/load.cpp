#include "worker/scene/load.h"

#include "worker/scene/gltf_source.h"

namespace tilefarm {

Scene loadGltf(const std::filesystem::path& path, const std::string& variant) {
    return GltfSource(path, {.variant = variant, .animation = "none"}).take();
}

}  // namespace tilefarm
