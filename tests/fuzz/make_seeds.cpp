// Writes what the fuzzers begin with, where the tree has no such files: jobs, a lease, scenes, pictures, and
// the words of glTF as a dictionary.
//     make_seeds FOLDER
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

#include "shared/image/exr.h"
#include "shared/job/wire.h"
#include "tests/fuzz/gltf_words.h"
#include "tests/fuzz/scene_seeds.h"

namespace {

using namespace tilefarm;
namespace fs = std::filesystem;
using nlohmann::json;

void write(const fs::path& path, std::span<const std::byte> bytes) {
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}
void write(const fs::path& path, std::string_view text) {
    write(path, std::as_bytes(std::span(text)));
}

JobSpec smallJob() {
    JobSpec job;
    job.scene = {"a.gltf", {{"a.gltf", std::string(64, 'a')}, {"sky.hdr", std::string(64, 'b')}}, "sky.hdr"};
    job.image = {16, 8, 8};
    return job;
}

void writeJobs(const fs::path& folder) {
    JobSpec job = smallJob();
    write(folder / "job.json", toJson(job).dump());
    job.lights = {LightSettings{}};
    job.materials = {MaterialOverride{}};
    json full = toJson(job);
    full["materials"][0]["baseColor"] = {0.5, 0.25, 1};
    full["materials"][0]["roughness"] = 0.5;
    write(folder / "full.json", full.dump());
    Lease lease;
    lease.id = lease.jobId = "x";
    lease.spec = smallJob();
    lease.passes = {{0, {0, 1}}, {1, {1, 1}}};
    write(folder / "lease.json", toJson(lease).dump());
    write(folder / "hello.json", toJson(WorkerHello{"w", "host", "device", "driver", "1"}).dump());
}

// What libFuzzer puts into bytes; the members of jobs it gets from job_mutator.cpp.
void writeDictionary(const fs::path& path) {
    std::string text;
    for (const std::string_view word : fuzz::kGltfWords) text += "\"\\\"" + std::string(word) + "\\\"\"\n";
    write(path, text);
}

// Writes a picture of halfs, floats and integers with an output file of OpenEXR's.
template <typename Output, typename Write>
void writeForeign(const fs::path& path, Imf::Header header, const Write& write) {
    const Imath::Box2i window = header.dataWindow();
    const size_t pixels = size_t(window.max.x + 1) * size_t(window.max.y + 1);
    const std::vector<uint32_t> values(pixels, 0x3c003c00);  // ones, as halfs
    Imf::FrameBuffer buffer;
    for (const auto& [name, type] : {std::pair{"R", Imf::HALF}, {"G", Imf::FLOAT}, {"id", Imf::UINT}}) {
        header.channels().insert(name, Imf::Channel(type));
        buffer.insert(name, Imf::Slice::Make(type, values.data(), window, sizeof(uint32_t)));
    }
    Output exr(path.c_str(), header, 0);
    exr.setFrameBuffer(buffer);
    write(exr);
}

// What others write: each of OpenEXR's methods, and tiles.
void writeForeignPictures(const fs::path& folder) {
    Imf::Header header(20, 9);
    for (int method = 0; method < Imf::NUM_COMPRESSION_METHODS; ++method) {
        header.compression() = static_cast<Imf::Compression>(method);
        writeForeign<Imf::OutputFile>(folder / ("method" + std::to_string(method) + ".exr"), header,
                                      [](auto& exr) { exr.writePixels(9); });
    }
    header.compression() = Imf::ZIP_COMPRESSION;
    header.setTileDescription(Imf::TileDescription(8, 8));
    writeForeign<Imf::TiledOutputFile>(folder / "tiled.exr", header, [](auto& exr) {
        exr.writeTiles(0, exr.numXTiles() - 1, 0, exr.numYTiles() - 1);
    });
}

void writePictures(const fs::path& folder) {
    const ImageSpec image{16, 8, 8};
    FloatImage picture{16, 8, {"R", "G", "B", "Z"}, {}};
    picture.planes.assign(4, std::vector<float>(picture.pixelCount(), 0.5f));
    fs::create_directories(folder);
    writeExr(folder / "picture.exr", picture, {{"job", "1"}});
    const TileGrid grid(image);
    writeFrameExr(folder / "frame.exr", image, [&](uint32_t tile) { return FilmTile(grid.rect(tile)); }, {});
    std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 16\n";
    for (int row = 0; row < 2; ++row)
        hdr += std::string("\x02\x02\x00\x10", 4) + "\x90\x81\x90\x81\x90\x81\x90\x81";
    write(folder / "sky.hdr", hdr);
}

// Of each layout that films can have, with faults and without.
void writeUploads(const fs::path& folder) {
    const ImageSpec image{16, 8, 8};
    const TileGrid grid(image);
    int number = 0;
    for (const FilmLayout& layout : FilmLayout::all()) {
        PassFilm film{0, grid.rect(0), {0, 1}, std::vector<PassPixel>(64), {}};
        film.layout = layout;
        film.extra.resize(64 * layout.floats());
        PassFilm other = film;
        other.tile = 1;
        other.rect = grid.rect(1);
        other.faults.rejectedPaths = 3;
        other.faults.truncatedPaths = 4;
        other.faults.clampedSamples = 5;
        other.faults.dropped.resize(2);
        const bool large = layout.floats() > 16;  // one part of these is enough
        const std::vector<PassFilm> films = large ? std::vector{film} : std::vector{film, other};
        write(folder / ("layout" + std::to_string(number++) + ".exr"),
              encodePassFilms(films, image, {{"job", "1"}}));
    }
}

void writeTextures(const fs::path& folder) {
    for (const auto& [channels, bits] : {std::pair{3u, 8u}, {4u, 8u}, {3u, 16u}, {4u, 16u}})
        write(folder / ("c" + std::to_string(channels) + "b" + std::to_string(bits) + ".png"),
              encodePng(5, 3, channels, bits, std::vector<uint16_t>(size_t{15} * channels, 300)));
    const std::vector<unsigned char> pixels(20 * 9 * 3, 99);
    int size = 0;
    // Compressed, which our own writer of PNG does not do.
    unsigned char* const png = stbi_write_png_to_mem(pixels.data(), 20 * 3, 20, 9, 3, &size);
    write(folder / "deflated.png", std::as_bytes(std::span(png, static_cast<size_t>(size))));
    STBIW_FREE(png);
    for (const int channels : {1, 3}) {
        const auto append = [](void* to, void* data, int bytes) {
            static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<size_t>(bytes));
        };
        std::string jpeg;
        stbi_write_jpg_to_func(append, &jpeg, 20, 9, channels, pixels.data(), channels == 1 ? 95 : 20);
        write(folder / ("c" + std::to_string(channels) + ".jpg"), jpeg);
    }
}

void writeRequests(const fs::path& folder) {
    for (const std::string_view range :
         {"bytes=0-9", "bytes=-5", "bytes=7-", "bytes=0-1,4-5", "lines=1-2", ""})
        write(folder / ("range" + std::to_string(range.size())),
              "100\n" + std::string(range) + "\n\"digest\"\n\n17\n");
    write(folder / "known", "0\nbytes=0-0\n\n\"other\", \"digest\"\n-0.5\n");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const fs::path folder = argv[1];
    writeJobs(folder / "job");
    writeDictionary(folder / "gltf.dict");
    writePictures(folder / "image");
    writeForeignPictures(folder / "image");
    writeTextures(folder / "image");
    writeUploads(folder / "upload");
    writeRequests(folder / "http");
    fs::create_directories(folder / "gltf");
    writeSceneSeeds(folder / "gltf");
    return 0;
}
