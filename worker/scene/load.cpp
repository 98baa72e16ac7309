#include "worker/scene/load.h"

#include <fmt/format.h>

#include <new>
#include <stdexcept>

#include "shared/error/error.h"
#include "worker/scene/extensions.h"
#include "worker/scene/materials.h"
#include "worker/scene/nodes.h"
#include "worker/scene/variants.h"

namespace tilefarm {
namespace {

void warnOfAnimations(LoadContext& load) {
    const JsonNode animations = load.file.root()["animations"];
    for (size_t i = 0; i < animations.size(); ++i) {
        load.warn("animations", animations[i], "rendered at rest");
    }
}

Scene loadChecked(const std::filesystem::path& path, const std::string& variant) {
    const GltfFile file(path);
    BufferViews views(file);
    Accessors accessors(file.root(), views);
    Scene scene;
    LoadContext load{file, views, accessors, scene};
    load.variant = findVariant(file.root(), variant);
    checkExtensions(load);
    Textures textures(load);
    scene.materials = parseMaterials(load, textures);
    Meshes meshes(load);
    loadNodes(load, meshes);
    warnOfAnimations(load);
    textures.decodeUsed(scene.materials, meshes.usedMaterials());
    return scene;
}

}  // namespace

Scene loadGltf(const std::filesystem::path& path, const std::string& variant) {
    // A small compressed file may honestly ask for more memory than there is.
    try {
        return loadChecked(path, variant);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::invalidArgument, fmt::format("{}: does not fit in memory", path.string()));
    } catch (const std::length_error&) {
        throw Error(ErrorCode::invalidArgument, fmt::format("{}: does not fit in memory", path.string()));
    }
}

}  // namespace tilefarm
