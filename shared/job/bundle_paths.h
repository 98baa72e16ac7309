#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace tilefarm {

/// A relative path in its one form: so many folders up from where it starts, then down without "." or ".."
/// or empty segments.
struct TidyPath {
    size_t levelsUp = 0;
    std::string rest;  // a leading '/' of an absolute path stays
    std::string text() const;
    friend bool operator==(const TidyPath&, const TidyPath&) = default;
};

/// The path that a relative URI, percent-decoded, leads to: "sub/../tex.png", "sub//../tex.png" and
/// "./tex.png" are "tex.png".
TidyPath tidyPath(std::string_view path);

/// Why a scene must not name this file, or an empty text. Within the scene's folder: as pathFault
/// (safe_path.h). Above it only what looks like an image or a buffer, so that a scene from elsewhere cannot
/// have other files of this machine sent along.
std::string referenceFault(const TidyPath& path);

/// Where the files of a scene lie in its bundle. Its root is as far above the scene's folder as the farthest
/// reference, so that no path in it has "..".
class BundleRoot {
public:
    /// Throws Error(invalidArgument) if there are not so many folders above that of `entry`.
    BundleRoot(const std::filesystem::path& entry, size_t levelsUp);

    /// The name of the .gltf or .glb, "models/chair.gltf".
    const std::string& entry() const { return entry_; }
    /// The name of a file that the scene refers to, at most levelsUp folders up: "textures/wood.png".
    std::string nameOf(const TidyPath& path) const;
    /// Where that file is.
    std::filesystem::path fileOf(const TidyPath& path) const { return root_ / nameOf(path); }

private:
    std::filesystem::path root_;
    std::string folder_;  // of the scene below the root: "" or "models/"
    std::string entry_;
};

/// How many folders up a scene's references may lead within a bundle that has it under this name.
size_t levelsAbove(std::string_view entry);

}  // namespace tilefarm
