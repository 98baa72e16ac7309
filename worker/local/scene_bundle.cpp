#include "worker/local/scene_bundle.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "worker/scene/gltf_file.h"
#include "worker/scene/part_list.h"
#include "worker/scene/uri.h"

namespace fs = std::filesystem;

namespace tilefarm {
namespace {

/// A file that the scene names, or nothing: those that are not there are the loader's affair, which knows
/// what is needed.
std::optional<TidyPath> namedFile(const JsonNode& element, const fs::path& entry) {
    std::optional<TidyPath> named;
    readIfSound(element, [&] {
        const JsonNode uri = element["uri"];
        if (!uri || isDataUri(uri.text())) return;
        const TidyPath path = relativePathOf(uri, std::numeric_limits<size_t>::max());
        if (const std::string fault = referenceFault(path); !fault.empty()) uri.fail(fault);
        const fs::path file = BundleRoot(entry, path.levelsUp).fileOf(path);
        if (!fs::is_regular_file(file)) uri.fail(fmt::format("names {}, which is not there", file.string()));
        named = path;
    });
    return named;
}

std::vector<TidyPath> namedFiles(const GltfFile& gltf, const fs::path& entry) {
    std::vector<TidyPath> files;
    for (const char* list : {"buffers", "images"}) {
        const JsonNode elements = gltf.root()[list];
        for (size_t i = 0; i < elements.size(); ++i)
            if (std::optional<TidyPath> file = namedFile(elements[i], entry))
                files.push_back(*std::move(file));
    }
    return files;
}

// As the command line names it in a job, so that both renders of a scene carry the same scene hash.
std::string environmentName(const SceneBundle& bundle, const fs::path& file) {
    std::string name = "environment/" + file.filename().string();
    while (bundle.files.contains(name)) name.insert(0, "environment/");
    return name;
}

}  // namespace

SceneBundle bundleOf(const SceneFiles& files, bool strict) {
    SceneBundle bundle;
    const GltfFile gltf(files.entry, {.strict = strict});
    const std::vector<TidyPath> named = namedFiles(gltf, files.entry);
    size_t levelsUp = 0;
    for (const TidyPath& path : named) levelsUp = std::max(levelsUp, path.levelsUp);
    const BundleRoot root(files.entry, levelsUp);
    bundle.entry = root.entry();
    bundle.files[bundle.entry] = sha256OfFile(files.entry);
    for (const TidyPath& path : named) {
        const std::string name = root.nameOf(path);
        if (!bundle.files.contains(name)) bundle.files[name] = sha256OfFile(root.fileOf(path));
    }
    if (!files.environment.empty()) {
        bundle.environment = environmentName(bundle, files.environment);
        bundle.files[bundle.environment] = sha256OfFile(files.environment);
    }
    return bundle;
}

}  // namespace tilefarm
