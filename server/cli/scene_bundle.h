#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "shared/job/bundle_paths.h"
#include "shared/job/job.h"

namespace tilefarm {

/// A file that a .gltf or .glb refers to.
struct FileReference {
    TidyPath path;      // from the glTF's folder, percent-decoded
    std::string place;  // JSON pointer, as "/images/3/uri"
    std::string fault;  // why it cannot be sent along, with its place, or empty
};

/// The files that the buffers and images of a glTF refer to, in the order of the JSON; data: URIs are
/// none. The fault of one says that its URI is absolute, has a scheme or is ill encoded, that it is above the
/// glTF's folder and looks like no part of a scene (bundle_paths.h), or that it is not there. Throws
/// Error(invalidArgument) that names file and JSON place for a file that is no glTF.
std::vector<FileReference> gltfReferences(const std::filesystem::path& gltf);

/// A scene's files, hashed.
struct BundledScene {
    SceneBundle bundle;
    std::map<std::string, std::filesystem::path> blobs;  // SHA-256 -> a file with these bytes
    std::vector<std::string> warnings;                   // of files that are left out as nothing needs them
};

/// The scene with all it refers to and, unless empty, an environment, which may lie anywhere. Paths in
/// the bundle are relative to the glTF's folder, or to one above it where a reference leads there. Throws
/// Error(invalidArgument) as gltfReferences, and for the fault of a reference, naming it and who refers to
/// it; unless the job is strict, of what it needs alone (needed_files.h).
BundledScene bundleScene(const std::filesystem::path& gltf, const std::filesystem::path& environment = {},
                         const JobSpec& job = {});

}  // namespace tilefarm
