#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "shared/job/job.h"

namespace tilefarm {

/// A file that a .gltf or .glb refers to.
struct FileReference {
    std::string path;   // relative to the glTF's folder, percent-decoded
    std::string place;  // JSON pointer, as "/images/3/uri"
};

/// The files that the buffers and images of a glTF refer to, in the order of the JSON; data: URIs are
/// none. Throws Error(invalidArgument) that names file and JSON place for a URI that is absolute, has
/// a scheme, leaves the glTF's folder or is ill encoded, and for a file that is no glTF.
std::vector<FileReference> gltfReferences(const std::filesystem::path& gltf);

/// A scene's files, hashed.
struct BundledScene {
    SceneBundle bundle;
    std::map<std::string, std::filesystem::path> blobs;  // SHA-256 -> a file with these bytes
};

/// The scene with all it refers to and, unless empty, an environment, which may lie anywhere. Paths in
/// the bundle are relative to the glTF's folder. Throws Error(invalidArgument) as gltfReferences, and
/// for a file that is missing, naming it and who refers to it.
BundledScene bundleScene(const std::filesystem::path& gltf, const std::filesystem::path& environment = {});

}  // namespace tilefarm
