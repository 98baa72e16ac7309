#include "server/cli/scene_bundle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>

#include "server/cli/needed_files.h"
#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "shared/file/durable_file.h"
#include "shared/job/bundle_paths.h"
#include "shared/job/wire.h"

namespace tilefarm {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A;  // "glTF", "JSON"
constexpr size_t kGlbHeader = 12, kChunkHeader = 8;

[[noreturn]] void fail(const fs::path& file, const std::string& fault) {
    throw Error(ErrorCode::invalidArgument, fmt::format("{}: {}", file.string(), fault));
}

std::string_view textOf(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

uint32_t wordAt(std::string_view bytes, size_t at) {
    uint32_t word = 0;
    std::memcpy(&word, bytes.data() + at, sizeof word);
    return word;
}

// The JSON of a .glb: its first chunk.
std::string_view jsonOfGlb(std::string_view bytes, const fs::path& file) {
    if (bytes.size() < kGlbHeader + kChunkHeader) fail(file, "ends within the header of a .glb");
    if (const uint32_t version = wordAt(bytes, 4); version != 2)
        fail(file, fmt::format("has version {} of the .glb container, not 2", version));
    const uint32_t size = wordAt(bytes, kGlbHeader);
    if (wordAt(bytes, kGlbHeader + 4) != kJsonChunk) fail(file, "does not begin with a chunk of JSON");
    if (size > bytes.size() - kGlbHeader - kChunkHeader)
        fail(file, fmt::format("ends within its chunk of {} bytes of JSON", size));
    const std::string_view text = bytes.substr(kGlbHeader + kChunkHeader, size);
    return text.substr(0, text.find_last_not_of('\0') + 1);  // some writers fill it up with zeros
}

// As deep as the worker reads. Which names may stand twice the worker knows; here a file is only looked
// through.
constexpr size_t kDeepest = 128;

json readGltf(const fs::path& file, bool strict) {
    std::vector<std::byte> bytes;
    try {
        bytes = readWhole(file);
    } catch (const Error& e) {
        throw Error(ErrorCode::invalidArgument, e.what());
    }
    std::string_view text = textOf(bytes);
    if (text.size() >= 4 && wordAt(text, 0) == kGlbMagic) text = jsonOfGlb(text, file);
    try {
        return parseJson(text, {.repeatedNames = !strict, .deepest = kDeepest});
    } catch (const Error& e) {
        fail(file, fmt::format("is no glTF: {}", e.what()));
    }
}

int hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::optional<std::string> percentDecoded(std::string_view uri) {
    std::string decoded;
    for (size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%') {
            decoded += uri[i];
            continue;
        }
        if (i + 2 >= uri.size() || hexDigit(uri[i + 1]) < 0 || hexDigit(uri[i + 2]) < 0) return std::nullopt;
        decoded += static_cast<char>(hexDigit(uri[i + 1]) * 16 + hexDigit(uri[i + 2]));
        i += 2;
    }
    return decoded;
}

// RFC 3986: a letter, then letters, digits, '+', '-', '.', up to a ':' before any '/'.
bool hasScheme(std::string_view uri) {
    const size_t colon = uri.find(':');
    return colon != std::string_view::npos && colon > 0 && colon < uri.find('/');
}

bool isDataUri(const std::string& uri) {
    constexpr std::string_view scheme = "data:";
    return uri.size() >= scheme.size() &&
           std::equal(scheme.begin(), scheme.end(), uri.begin(),
                      [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

FileReference referenceOf(const fs::path& file, const std::string& uri, const std::string& place) {
    const auto refused = [&](std::string_view why) {
        return FileReference{{}, place, fmt::format("{}: '{}' {}", place, uri.substr(0, 200), why)};
    };
    if (hasScheme(uri)) return refused("has a scheme; only files beside the scene can be sent along");
    const auto decoded = percentDecoded(uri);
    if (!decoded) return refused("is not percent-encoded as a URI must be");
    const TidyPath path = tidyPath(*decoded);
    if (const std::string fault = referenceFault(path); !fault.empty()) return refused(fault);
    try {
        const fs::path named = BundleRoot(file, path.levelsUp).fileOf(path);
        if (fs::is_regular_file(named)) return {path, place, {}};
        return {path, place, fmt::format("{}: there is no file '{}'", place, named.string())};
    } catch (const Error&) {
        return refused("is above all folders");
    }
}

// Adds a file to the bundle under `path`.
void add(BundledScene& scene, const std::string& path, const fs::path& file) {
    const std::string digest = sha256OfFile(file);
    scene.bundle.files[path] = digest;
    scene.blobs[digest] = file;
}

void addEnvironment(BundledScene& scene, const fs::path& file) {
    if (!fs::is_regular_file(file)) fail(file, "the environment does not exist");
    std::string path = "environment/" + file.filename().string();
    while (scene.bundle.files.contains(path)) path.insert(0, "environment/");
    add(scene, path, file);
    scene.bundle.environment = path;
}

std::vector<FileReference> referencesIn(const json& document, const fs::path& gltf) {
    if (!document.is_object()) fail(gltf, "is no glTF: its JSON is no object");
    std::vector<FileReference> references;
    for (const char* kind : {"buffers", "images"}) {
        const auto list = document.find(kind);
        if (list == document.end()) continue;
        if (!list->is_array()) fail(gltf, fmt::format("/{} must be a list", kind));
        for (size_t i = 0; i < list->size(); ++i) {
            const std::string place = fmt::format("/{}/{}/uri", kind, i);
            const json& entry = (*list)[i];
            if (!entry.is_object()) fail(gltf, fmt::format("/{}/{} must be an object", kind, i));
            const auto uri = entry.find("uri");
            if (uri == entry.end()) continue;  // in the .glb itself, or in a buffer view
            if (!uri->is_string()) fail(gltf, place + " must be a string");
            if (const auto& text = uri->get_ref<const std::string&>(); !isDataUri(text))
                references.push_back(referenceOf(gltf, text, place));
        }
    }
    return references;
}

// Without those that are not needed and cannot be sent, of which the scene gets a warning.
std::vector<FileReference> usable(std::vector<FileReference> references, const std::set<std::string>& needed,
                                  const fs::path& gltf, bool strict, std::vector<std::string>& warnings) {
    std::erase_if(references, [&](const FileReference& reference) {
        if (reference.fault.empty()) return false;
        if (strict || needed.contains(reference.place)) fail(gltf, reference.fault);
        warnings.push_back(fmt::format("{}; nothing that is rendered needs it", reference.fault));
        return true;
    });
    return references;
}

}  // namespace

std::vector<FileReference> gltfReferences(const fs::path& gltf) {
    return referencesIn(readGltf(gltf, false), gltf);
}

BundledScene bundleScene(const fs::path& gltf, const fs::path& environment, const JobSpec& job) {
    BundledScene scene;
    const json document = readGltf(gltf, job.strict);
    const std::vector<FileReference> references =
        usable(referencesIn(document, gltf), neededFiles(document, job), gltf, job.strict, scene.warnings);
    size_t levelsUp = 0;
    for (const FileReference& reference : references) levelsUp = std::max(levelsUp, reference.path.levelsUp);
    const BundleRoot root(gltf, levelsUp);
    scene.bundle.entry = root.entry();
    add(scene, scene.bundle.entry, gltf);
    for (const FileReference& reference : references) {
        const std::string name = root.nameOf(reference.path);
        if (!scene.bundle.files.contains(name)) add(scene, name, root.fileOf(reference.path));
    }
    if (!environment.empty()) addEnvironment(scene, environment);
    return scene;
}

}  // namespace tilefarm
