#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace tilefarm {

/// Makes small glTF files for tests: JSON set by pointers, and one binary buffer that grows.
class GltfBuilder {
public:
    /// An asset with an empty scene 0 and buffer 0.
    GltfBuilder();
    ~GltfBuilder();
    /// One triangle (0,0,0), (1,0,0), (0,1,0) at /meshes/0, with /nodes/0 showing it.
    static GltfBuilder triangle();
    /// A unit square in the xy plane facing +z, with normals, texture coordinates (v down) and indices;
    /// material 0, node 0.
    static GltfBuilder square();

    GltfBuilder(GltfBuilder&&) noexcept;
    GltfBuilder& operator=(GltfBuilder&&) noexcept;

    /// Sets what the pointer names to a JSON text; makes what leads there.
    GltfBuilder& set(const std::string& pointer, const std::string& json);
    GltfBuilder& set(const std::string& pointer, uint32_t value) {
        return set(pointer, std::to_string(value));
    }
    GltfBuilder& erase(const std::string& pointer);

    /// A buffer view of the bytes, which begin at a multiple of 8.
    uint32_t view(std::span<const std::byte> bytes, uint32_t stride = 0);
    /// Where the bytes of a view begin in the buffer.
    uint32_t offsetOf(uint32_t view) const;
    /// An accessor of `type` over a view.
    uint32_t accessorOf(uint32_t view, const char* type, uint32_t componentType, size_t count,
                        bool normalized = false);

    template <typename T>
    uint32_t accessor(const std::vector<T>& values, const char* type, bool normalized = false) {
        return accessorOf(view(std::as_bytes(std::span(values))), type, componentType(T{}),
                          values.size() / componentsOf(type), normalized);
    }
    uint32_t accessor(const std::vector<glm::vec2>& v) { return vectors(v, "VEC2"); }
    uint32_t accessor(const std::vector<glm::vec3>& v) { return vectors(v, "VEC3"); }
    uint32_t accessor(const std::vector<glm::vec4>& v) { return vectors(v, "VEC4"); }

    /// Length of an array that a pointer names, 0 where it is missing.
    size_t size(const std::string& pointer) const;

    std::filesystem::path writeGltf(const std::filesystem::path& folder,
                                    const std::string& name = "scene.gltf");
    std::filesystem::path writeEmbedded(const std::filesystem::path& folder,
                                        const std::string& name = "scene.gltf");
    std::filesystem::path writeGlb(const std::filesystem::path& folder,
                                   const std::string& name = "scene.glb");

private:
    template <typename V>
    uint32_t vectors(const std::vector<V>& values, const char* type) {
        return accessorOf(view(std::as_bytes(std::span(values))), type, 5126, values.size());
    }
    static uint32_t componentsOf(const std::string& type) {
        return type == "SCALAR" ? 1u : uint32_t(type[3] - '0');
    }
    static uint32_t componentType(int8_t) { return 5120; }
    static uint32_t componentType(uint8_t) { return 5121; }
    static uint32_t componentType(int16_t) { return 5122; }
    static uint32_t componentType(uint16_t) { return 5123; }
    static uint32_t componentType(uint32_t) { return 5125; }
    static uint32_t componentType(float) { return 5126; }
    void setByteLength();

    std::unique_ptr<nlohmann::json> json_;
    std::vector<std::byte> binary_;
    bool lengthGiven_ = false;
};

void writeBytes(const std::filesystem::path& path, std::span<const std::byte> bytes);
void writeText(const std::filesystem::path& path, const std::string& text);
std::string base64(std::span<const std::byte> bytes);

/// An uncompressed PNG of 8 or 16 bits (numbers as given, the high byte written first), 3 or 4 channels.
std::vector<std::byte> encodePng(uint32_t width, uint32_t height, uint32_t channels, uint32_t bits,
                                 const std::vector<uint16_t>& values);

}  // namespace tilefarm
