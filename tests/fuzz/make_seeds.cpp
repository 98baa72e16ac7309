// Writes what the fuzzers begin with, where the tree has no such files: jobs, a lease, scenes, pictures, and
// the words of our JSON as a dictionary. From the code itself, so that new members are fuzzed as soon as they
// are there.
//     make_seeds FOLDER
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "shared/image/exr.h"
#include "shared/job/wire.h"
#include "tests/fuzz/seed_file.h"

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

void collectWords(const json& schema, std::set<std::string>& words) {
    if (schema.is_object())
        for (const auto& [key, value] : schema.items()) {
            if (key == "properties")
                for (const auto& [name, member] : value.items()) words.insert(name);
            if (key == "enum")
                for (const json& word : value) words.insert(word.get<std::string>());
            collectWords(value, words);
        }
    if (schema.is_array())
        for (const json& item : schema) collectWords(item, words);
}

void writeDictionary(const fs::path& path) {
    std::set<std::string> words;
    collectWords(jobSchema(), words);
    std::string text;
    for (const std::string& word : words) text += "\"\\\"" + word + "\\\"\"\n";
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

void writeScenes(const fs::path& folder) {
    fs::create_directories(folder);
    seedFile().writeGlb(folder, "seed.glb");
    seedFile().writeEmbedded(folder, "seed.gltf");
    for (const bool edgebreaker : {false, true})
        dracoFile(edgebreaker).writeGlb(folder, edgebreaker ? "edgebreaker.glb" : "sequential.glb");
}

void writePictures(const fs::path& folder) {
    const ImageSpec image{16, 8, 8};
    FloatImage picture{16, 8, {"R", "G", "B", "Z"}, {}};
    picture.planes.assign(4, std::vector<float>(picture.pixelCount(), 0.5f));
    fs::create_directories(folder);
    writeExr(folder / "picture.exr", picture, {{"job", "1"}});
    const TileGrid grid(image);
    writeFrameExr(folder / "frame.exr", image, [&](uint32_t tile) { return FilmTile(grid.rect(tile)); }, {});
    PassFilm film{0, grid.rect(0), {0, 1}, std::vector<PassPixel>(64), {}};
    write(folder / "passes.exr", encodePassFilms(std::span(&film, 1), image, {}));
    std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 16\n";
    for (int row = 0; row < 2; ++row)
        hdr += std::string("\x02\x02\x00\x10", 4) + "\x90\x81\x90\x81\x90\x81\x90\x81";
    write(folder / "sky.hdr", hdr);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const fs::path folder = argv[1];
    writeJobs(folder / "job");
    writeDictionary(folder / "job.dict");
    writePictures(folder / "image");
    writeForeignPictures(folder / "image");
    writeScenes(folder / "gltf");
    return 0;
}
