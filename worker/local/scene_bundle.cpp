#include "worker/local/scene_bundle.h"

#include <fmt/format.h>

#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "worker/scene/gltf_file.h"
#include "worker/scene/uri.h"

namespace fs = std::filesystem;

namespace tilefarm {
namespace {

void addNamedFiles(const JsonNode& list, const fs::path& folder, SceneBundle& bundle) {
    for (size_t i = 0; i < list.size(); ++i) {
        const JsonNode uri = list[i]["uri"];
        if (!uri || isDataUri(uri.text())) continue;
        const fs::path path = relativePathOf(uri);
        if (!fs::is_regular_file(folder / path))
            uri.fail(fmt::format("names {}, which is not there", (folder / path).string()));
        bundle.files.try_emplace(path.generic_string(), sha256OfFile(folder / path));
    }
}

// As the command line names it in a job, so that both renders of a scene carry the same scene hash.
std::string environmentName(const SceneBundle& bundle, const fs::path& file) {
    std::string name = "environment/" + file.filename().string();
    while (bundle.files.contains(name)) name.insert(0, "environment/");
    return name;
}

}  // namespace

SceneBundle bundleOf(const SceneFiles& files) {
    SceneBundle bundle;
    const fs::path folder = files.entry.parent_path();
    bundle.entry = files.entry.filename().string();
    const GltfFile gltf(files.entry);
    bundle.files[bundle.entry] = sha256OfFile(files.entry);
    addNamedFiles(gltf.root()["buffers"], folder, bundle);
    addNamedFiles(gltf.root()["images"], folder, bundle);
    if (!files.environment.empty()) {
        bundle.environment = environmentName(bundle, files.environment);
        bundle.files[bundle.environment] = sha256OfFile(files.environment);
    }
    return bundle;
}

}  // namespace tilefarm
