// libFuzzer: whatever a .gltf or .glb holds, the loader gives sound scenes at all times or an Error. How
// files are changed: gltf_mutator.cpp.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "shared/error/error.h"
#include "worker/scene/gltf_source.h"
#include "worker/scene/load.h"
#include "worker/scene/world.h"

namespace {

using namespace tilefarm;

constexpr uint64_t kMostCorners = 1 << 20;  // a file may ask for more with its instances, and honestly so

// One texel.
constexpr unsigned char kPng[] = {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d,
                                  0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01,
                                  0x08, 0x02, 0x00, 0x00, 0x00, 0x90, 0x77, 0x53, 0xde, 0x00, 0x00, 0x00,
                                  0x0c, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60, 0x64, 0x62, 0x06,
                                  0x00, 0x00, 0x0e, 0x00, 0x07, 0xd7, 0x6f, 0xe4, 0x78, 0x00, 0x00, 0x00,
                                  0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

// The loader reads files: those of a folder of this process, which has two beside the scene.
const std::filesystem::path& scenePath() {
    static const std::filesystem::path path = [] {
        const std::filesystem::path memory = "/dev/shm";  // no disk is worn
        const auto folder =
            (std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path()) /
            ("tilefarm-fuzz-" + std::to_string(getpid()));
        std::filesystem::create_directories(folder);
        static const struct Remover {
            std::filesystem::path folder;
            ~Remover() {
                std::error_code ignored;
                std::filesystem::remove_all(folder, ignored);
            }
        } remover{folder};
        std::ofstream(folder / "a.bin", std::ios::binary) << std::string(256, '\0');
        std::ofstream(folder / "a.png", std::ios::binary)
            .write(reinterpret_cast<const char*>(kPng), sizeof kPng);
        return folder / "scene.gltf";
    }();
    return path;
}

void require(bool sound) {
    if (!sound) std::abort();
}

bool isFinite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void requireSoundTextures(const Scene& scene, const Material& material) {
    for (const TextureRef& texture :
         {material.baseColorTexture, material.normalTexture, material.emissionTexture,
          material.metallicRoughnessTexture, material.specularColorTexture})
        require(!texture || texture.image < scene.images.size());
}

void requireSound(Scene& scene) {
    for (const Image& image : scene.images) {
        const size_t texels = size_t{image.width} * image.height * 4;
        require(image.rgba8.size() + image.rgbaFloat.size() == texels);
    }
    for (const Material& material : scene.materials) requireSoundTextures(scene, material);
    for (const Mesh& mesh : scene.meshes) {
        require(mesh.material < scene.materials.size());
        for (const glm::uvec3 t : mesh.triangles) require(std::max({t.x, t.y, t.z}) < mesh.positions.size());
        for (const size_t length : {mesh.normals.size(), mesh.tangents.size(), mesh.uv0.size(),
                                    mesh.uv1.size(), mesh.colors.size()})
            require(length == 0 || length == mesh.positions.size());
    }
    uint64_t corners = 0;
    for (const Instance& instance : scene.instances) {
        require(instance.mesh < scene.meshes.size());
        corners +=
            scene.meshes[instance.mesh].positions.size() + scene.meshes[instance.mesh].triangles.size();
    }
    for (const Shape& shape : scene.shapes) require(shape.material < scene.materials.size());
    selectCamera(scene, "auto", 1.5);
    lightIfDark(scene);
    if (corners > kMostCorners) return;
    const WorldGeometry world = flatten(scene);
    for (const glm::vec3 corner : world.corners()) require(isFinite(corner));
    for (const WorldShape& shape : world.shapes) require(isFinite(shape.lower) && isFinite(shape.upper));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    std::ofstream(scenePath(), std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
        GltfSource source(scenePath(), {.loop = size % 2 == 0});
        const double seconds = source.seconds();
        require(std::isfinite(seconds));
        requireSound(source.at(0));
        if (source.animated())
            for (const double time : {seconds / 3, seconds, -1.0, 1e9}) requireSound(source.at(time));
        require(source.animated() || !source.moves());
    } catch (const Error& error) {
        require(error.code == ErrorCode::invalidArgument);
    }
    return 0;
}
