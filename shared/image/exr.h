#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "shared/film/film.h"
#include "shared/image/exr_attributes.h"
#include "shared/image/float_image.h"
#include "shared/image/primaries.h"

namespace tilefarm {

/// Gives one tile of the frame; called once per tile, row of tiles by row of tiles from the top.
using TileSource = std::function<FilmTile(uint32_t tile)>;

/// What the file of a frame holds beyond the channels that every one has.
struct FrameContents {
    FilmLayout layout{};                            // of the tiles
    std::map<std::string, std::string> metadata{};  // further header entries, by their full names
};

/// Writes a frame as a scanline EXR (fp32, ZIP) a row of tiles at a time, so memory holds one row of
/// tiles and not the frame. Channels: R G B A, variance.R variance.G variance.B (of the mean),
/// samples.X, albedo.R albedo.G albedo.B, normal.X normal.Y normal.Z, Z (depth), and those of
/// `contents.layout`, with uv.A, which is A: ids by falling coverage, beside their coverage from 0 to 1.
/// Written to a temporary file beside `path`, synced, then renamed: `path` is whole or absent. Throws
/// Error(outOfSpace | internal) that names the file.
void writeFrameExr(const std::filesystem::path& path, const ImageSpec& image, const TileSource& tiles,
                   const ImageAttributes& attributes, const FrameContents& contents = {});

/// Reads every channel of the first part of an EXR as fp32. Throws Error(invalidArgument) that names
/// the file and the fault, also for truncated and hostile files.
FloatImage readExr(const std::filesystem::path& path);
FloatImage readExr(std::span<const std::byte> bytes, const std::string& nameForErrors);

/// Pixels of a plane whose y goes down, from (x, y) on.
struct ExrWindow {
    int64_t x = 0, y = 0, width = 0, height = 0;
    friend bool operator==(const ExrWindow&, const ExrWindow&) = default;
};

/// Pixels with what the header says of them.
struct ExrPicture {
    FloatImage image;         // of the data window
    std::vector<bool> half;   // by channel: stored as half
    ExrWindow data, display;  // the latter may have no bounds that a reader could take
    float pixelAspectRatio = 1;
    bool cubeMap = false;  // the attribute `envmap`, in the layout of ImfEnvmap.h
    Primaries primaries;   // the attribute `chromaticities`, else Rec. 709
    Primaries::Xy
        neutral;       // what is to look white: the attribute `adoptedNeutral`, else the primaries' white
    size_t parts = 1;  // of the file; the picture is the first
};
ExrPicture readExrPicture(const std::filesystem::path& path);

/// The "tilefarm.*" attributes of a file, without the prefix.
ImageAttributes readExrAttributes(const std::filesystem::path& path);
/// All header entries that are strings, by their full names.
ImageAttributes readExrMetadata(const std::filesystem::path& path);
/// Writes any planes (fp32, ZIP); for tests and tools.
void writeExr(const std::filesystem::path& path, const FloatImage& image,
              const ImageAttributes& attributes = {});

/// The upload of a worker: one EXR, a part per pass and tile with its data window in the frame, fp32,
/// uncompressed (compressing costs more CPU than a local network saves). Bit-exact round trip.
std::vector<std::byte> encodePassFilms(std::span<const PassFilm> films, const ImageSpec& image,
                                       const ImageAttributes& attributes);
/// What encodePassFilms wrote. Throws Error(unprocessable) that names the part and the fault.
std::vector<PassFilm> decodePassFilms(std::span<const std::byte> bytes);
ImageAttributes decodePassAttributes(std::span<const std::byte> bytes);

}  // namespace tilefarm
