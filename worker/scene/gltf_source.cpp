#include "worker/scene/gltf_source.h"

#include <fmt/format.h>

#include <new>
#include <stdexcept>

#include "shared/error/error.h"
#include "worker/scene/animations.h"
#include "worker/scene/extensions.h"
#include "worker/scene/material_override.h"
#include "worker/scene/materials.h"
#include "worker/scene/nodes.h"
#include "worker/scene/variants.h"

namespace tilefarm {
namespace {

// A small compressed file may honestly ask for more memory than there is.
template <typename Work>
auto within(const std::filesystem::path& path, Work work) {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::invalidArgument, fmt::format("{}: does not fit in memory", path.string()));
    } catch (const std::length_error&) {
        throw Error(ErrorCode::invalidArgument, fmt::format("{}: does not fit in memory", path.string()));
    }
}

void warnOfScenes(LoadContext& load) {
    const JsonNode scenes = load.file.root()["scenes"];
    if (scenes.size() > 1) {
        const uint64_t shown = load.file.root()["scene"].integerOr(0, kNone - 1);
        if (shown < scenes.size()) {  // else a fault, found where nodes are read
            load.warn("scenes", scenes, fmt::format("only {} is rendered", labelOf(scenes[shown])));
        }
    }
}

// Of light whose lumens are known and its spectrum is not: lm/W at 555 nm, as Blender's importer divides by.
constexpr double kLumensPerWatt = 683;

LoadContext& checked(LoadContext& load, const GltfOptions& options) {
    load.variant = findVariant(load.file.root(), options.variant);
    if (options.lightUnits == LightUnits::photometric) load.lightUnit = 1 / kLumensPerWatt;
    checkExtensions(load);
    warnOfScenes(load);
    return load;
}

}  // namespace

struct GltfSource::Impl {
    Impl(const std::filesystem::path& from, const GltfOptions& given)
        : path(from),
          options(given),
          file(from, {given.strict, given.levelsUp}),
          views(file),
          accessors(file.root(), views),
          load{file, views, accessors, scene},
          textures(checked(load, options)),
          animations(load, options.animation, options.loop),
          skins(parseSkins(load)) {
        scene.materials = parseMaterials(load, textures, options);
        applyOverrides(scene, options.materials);
        meshes.emplace(load);
    }

    /// What lasts is moved over; whatever else the scene may hold is read anew.
    void pose(double seconds) {
        Scene next;
        next.images = std::move(scene.images);
        next.meshes = std::move(scene.meshes);
        next.environment = std::move(scene.environment);
        next.warnings = std::move(scene.warnings);
        scene = std::move(next);
        scene.lightChanges = animations.changeLight();
        scene.sizesChange = !animations.empty();
        animations.apply(file.document(), seconds);
        accessors.beginPose();
        scene.materials = parseMaterials(load, textures, options);
        // Before the meshes are read, whose tangents depend on what their material is.
        applyOverrides(scene, options.materials);
        meshes->beginPose();
        loadNodes(load, *meshes, skins);
        requireSomething();
        scene.degenerateTriangles = meshes->degenerateTriangles();
        textures.decodeUsed(scene.materials, meshes->usedMaterials());
        takeWarnings();
    }

    /// Of a broken file that shows nothing at all its owner wants to hear what is wrong, not to see an empty
    /// picture.
    void requireSomething() const {
        const bool empty = scene.instances.empty() && scene.shapes.empty() && scene.cameras.empty() &&
                           scene.lights.empty() && scene.areaLights.empty();
        if (const std::optional<Error>& fault = file.document().firstForgiven(); empty && fault) throw *fault;
    }

    /// Those that the document has gathered since the last pose.
    void takeWarnings() {
        const std::vector<SceneWarning>& all = file.document().warnings();
        scene.warnings.insert(scene.warnings.end(), all.begin() + static_cast<std::ptrdiff_t>(taken),
                              all.end());
        taken = all.size();
    }

    std::filesystem::path path;
    size_t taken = 0;  // of the document's warnings
    GltfOptions options;
    GltfFile file;
    BufferViews views;
    Accessors accessors;
    Scene scene;
    LoadContext load;
    Textures textures;
    Animations animations;
    PartList<Skin> skins;
    std::optional<Meshes> meshes;
};

GltfSource::GltfSource(const std::filesystem::path& path, GltfOptions options)
    : impl_(within(path, [&] { return std::make_unique<Impl>(path, options); })) {}

GltfSource::~GltfSource() = default;

bool GltfSource::animated() const {
    return !impl_->animations.empty();
}

bool GltfSource::moves() const {
    return !impl_->animations.camerasOnly(impl_->file.root());
}

double GltfSource::seconds() const {
    return impl_->animations.seconds();
}

Scene& GltfSource::at(double seconds) {
    within(impl_->path, [&] { impl_->pose(seconds); });
    return impl_->scene;
}

Scene GltfSource::take() {
    return std::move(at(0));
}

}  // namespace tilefarm
