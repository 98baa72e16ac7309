#include "tests/bench/bench_glb.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <glm/gtc/type_ptr.hpp>
#include <nlohmann/json.hpp>

#include "shared/error/error.h"

namespace tilefarm::bench {
namespace {

using nlohmann::json;

class GlbWriter {
public:
    explicit GlbWriter(const Scene& scene) {
        for (const Material& m : scene.materials) addMaterial(m);
        for (const Mesh& m : scene.meshes) addMesh(m);
        for (const Instance& i : scene.instances) addNode({{"mesh", i.mesh}}, i.toWorld);
        for (const Camera& c : scene.cameras) {
            const json perspective{{"yfov", c.yfov}, {"znear", 0.01}};
            document_["cameras"].push_back(
                {{"name", c.name}, {"type", "perspective"}, {"perspective", perspective}});
            addNode({{"camera", document_["cameras"].size() - 1}}, c.toWorld);
        }
        document_["buffers"] = json::array({{{"byteLength", buffer_.size()}}});
    }

    void write(const std::filesystem::path& path) const {
        std::string text = document_.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::ofstream file(path, std::ios::binary);
        const auto word = [&](size_t value) {
            const auto narrow = uint32_t(value);
            file.write(reinterpret_cast<const char*>(&narrow), 4);
        };
        file << "glTF";
        word(2), word(28 + text.size() + buffer_.size());
        word(text.size()), file << "JSON" << text;
        word(buffer_.size()), file.write("BIN\0", 4).write(buffer_.data(), std::streamsize(buffer_.size()));
        file.close();
        if (!file) throw Error(ErrorCode::internal, "cannot write " + path.string());
    }

private:
    void addMaterial(const Material& m) {
        const float strength = std::max({m.emission.x, m.emission.y, m.emission.z, 1.0f});
        json material{
            {"name", m.name},
            {"pbrMetallicRoughness",
             {{"baseColorFactor", {m.baseColor.x, m.baseColor.y, m.baseColor.z, 1.0f}},
              {"metallicFactor", m.metallic},
              {"roughnessFactor", m.roughness}}},
            {"emissiveFactor", {m.emission.x / strength, m.emission.y / strength, m.emission.z / strength}}};
        if (strength > 1)
            material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
        document_["materials"].push_back(std::move(material));
    }

    template <typename T>
    size_t addAccessor(const std::vector<T>& rows, size_t count, int component, const char* type) {
        const size_t offset = buffer_.size(), bytes = rows.size() * sizeof(T);
        buffer_.resize(offset + bytes);  // every row is a multiple of four bytes, so all stays aligned
        std::memcpy(buffer_.data() + offset, rows.data(), bytes);
        document_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
        document_["accessors"].push_back({{"bufferView", document_["bufferViews"].size() - 1},
                                          {"componentType", component},
                                          {"count", count},
                                          {"type", type}});
        return document_["accessors"].size() - 1;
    }

    void addMesh(const Mesh& m) {
        const size_t positions = addAccessor(m.positions, m.positions.size(), 5126, "VEC3");
        glm::vec3 low = m.positions.at(0), high = low;
        for (glm::vec3 p : m.positions) low = glm::min(low, p), high = glm::max(high, p);
        document_["accessors"][positions]["min"] = {low.x, low.y, low.z};
        document_["accessors"][positions]["max"] = {high.x, high.y, high.z};
        const size_t indices = addAccessor(m.triangles, m.triangles.size() * 3, 5125, "SCALAR");
        const json primitive{
            {"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", m.material}};
        document_["meshes"].push_back({{"name", m.name}, {"primitives", json::array({primitive})}});
    }

    void addNode(json node, const glm::dmat4& toWorld) {
        node["matrix"] = std::vector<double>(glm::value_ptr(toWorld), glm::value_ptr(toWorld) + 16);
        document_["nodes"].push_back(std::move(node));
        document_["scenes"][0]["nodes"].push_back(document_["nodes"].size() - 1);
    }

    json document_{{"asset", {{"version", "2.0"}}},
                   {"scene", 0},
                   {"scenes", json::array({{{"nodes", json::array()}}})},
                   {"extensionsUsed", {"KHR_materials_emissive_strength"}}};
    std::vector<char> buffer_;
};

}  // namespace

void writeGlb(const Scene& scene, const std::filesystem::path& path) {
    GlbWriter(scene).write(path);
}

}  // namespace tilefarm::bench
