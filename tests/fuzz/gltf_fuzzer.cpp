// libFuzzer: whatever a .gltf or .glb holds, the loader gives a sound scene or an Error.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "shared/error/error.h"
#include "worker/scene/load.h"
#include "worker/scene/world.h"

namespace {

using namespace tilefarm;

// The loader reads files, and nothing beside them: in an empty folder of this process.
const std::filesystem::path& scenePath() {
    static const std::filesystem::path path = [] {
        const auto folder =
            std::filesystem::temp_directory_path() / ("tilefarm-fuzz-" + std::to_string(getpid()));
        std::filesystem::create_directories(folder);
        static const struct Remover {
            std::filesystem::path folder;
            ~Remover() {
                std::error_code ignored;
                std::filesystem::remove_all(folder, ignored);
            }
        } remover{folder};
        return folder / "scene.gltf";
    }();
    return path;
}

void requireSound(const Scene& scene) {
    for (const Mesh& mesh : scene.meshes) {
        if (mesh.material >= scene.materials.size()) std::abort();
        for (const glm::uvec3 t : mesh.triangles)
            if (std::max({t.x, t.y, t.z}) >= mesh.positions.size()) std::abort();
    }
    for (const glm::vec3 corner : flatten(scene).corners())
        if (!std::isfinite(corner.x + corner.y + corner.z)) std::abort();
    selectCamera(scene, "auto", 1.5);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    std::ofstream(scenePath(), std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
        requireSound(loadGltf(scenePath()));
    } catch (const Error& error) {
        if (error.code != ErrorCode::invalidArgument) std::abort();
    }
    return 0;
}
