// Our reader against tinygltf's: two programs that share no line must find the same surface. Compared by
// world-space area and area-weighted centroid, which every vertex, index and transform enters.
//
// The header's implementation is compiled in here: Debian's libdraco exports a tinygltf of its own with another
// layout, and a program that links libtinygltf beside it calls whichever the dynamic linker meets first.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_INCLUDE_JSON
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <cstring>
#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "worker/scene/load.h"
#include "worker/scene/world.h"

namespace tilefarm {
namespace {

struct SurfaceSums {
    double area = 0;
    glm::dvec3 moment{0};  // Σ area · centroid

    void add(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        const double triangle = 0.5 * glm::length(glm::cross(b - a, c - a));
        area += triangle;
        moment += triangle * (a + b + c) / 3.0;
    }
};

SurfaceSums ofOurs(const std::filesystem::path& path) {
    const WorldGeometry world = flatten(loadGltf(path));
    SurfaceSums sums;
    const auto at = [&](uint32_t i) { return glm::dvec3(world.positions[i]) + world.centre; };
    for (const glm::uvec3& t : world.triangles) sums.add(at(t.x), at(t.y), at(t.z));
    return sums;
}

class TinyGltfSums {
public:
    explicit TinyGltfSums(const std::filesystem::path& path) {
        tinygltf::TinyGLTF loader;
        loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int,
                                 const unsigned char*, int, void*) { return true; },
                              nullptr);
        std::string error, warning;
        const bool good = path.extension() == ".glb"
                              ? loader.LoadBinaryFromFile(&model_, &error, &warning, path.string())
                              : loader.LoadASCIIFromFile(&model_, &error, &warning, path.string());
        EXPECT_TRUE(good) << error;
        const auto& scene = model_.scenes.at(static_cast<size_t>(std::max(model_.defaultScene, 0)));
        for (const int root : scene.nodes) addNode(root, glm::dmat4(1));
    }
    SurfaceSums sums;

private:
    static glm::dmat4 transformOf(const tinygltf::Node& node) {
        if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
        glm::dmat4 m(1);
        if (node.translation.size() == 3) m[3] = glm::dvec4(glm::make_vec3(node.translation.data()), 1);
        if (node.rotation.size() == 4)
            m = m * glm::mat4_cast(
                        glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
        if (node.scale.size() == 3)
            for (int i = 0; i < 3; ++i) m[i] *= node.scale[static_cast<size_t>(i)];
        return m;
    }

    const unsigned char* element(const tinygltf::Accessor& accessor, size_t i) const {
        const auto& view = model_.bufferViews.at(static_cast<size_t>(accessor.bufferView));
        return model_.buffers.at(static_cast<size_t>(view.buffer)).data.data() + view.byteOffset +
               accessor.byteOffset + i * static_cast<size_t>(accessor.ByteStride(view));
    }

    size_t indexAt(const tinygltf::Primitive& primitive, size_t i) const {
        if (primitive.indices < 0) return i;
        const auto& accessor = model_.accessors.at(static_cast<size_t>(primitive.indices));
        uint32_t index = 0;  // little-endian: the low bytes suffice
        std::memcpy(&index, element(accessor, i),
                    static_cast<size_t>(
                        tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(accessor.componentType))));
        return index;
    }

    glm::dvec3 positionAt(const tinygltf::Primitive& primitive, size_t i) const {
        const auto& accessor = model_.accessors.at(static_cast<size_t>(primitive.attributes.at("POSITION")));
        glm::vec3 position;
        std::memcpy(&position, element(accessor, indexAt(primitive, i)), sizeof position);
        return position;
    }

    void addPrimitive(const tinygltf::Primitive& primitive, const glm::dmat4& toWorld) {
        const int counted = primitive.indices >= 0 ? primitive.indices : primitive.attributes.at("POSITION");
        const size_t corners = model_.accessors.at(static_cast<size_t>(counted)).count;
        const auto at = [&](size_t i) {
            return glm::dvec3(toWorld * glm::dvec4(positionAt(primitive, i), 1));
        };
        for (size_t i = 0; i + 2 < corners; i += 3) sums.add(at(i), at(i + 1), at(i + 2));
    }

    void addNode(int index, const glm::dmat4& parent) {
        const auto& node = model_.nodes.at(static_cast<size_t>(index));
        const glm::dmat4 toWorld = parent * transformOf(node);
        if (node.mesh >= 0)
            for (const auto& primitive : model_.meshes.at(static_cast<size_t>(node.mesh)).primitives)
                addPrimitive(primitive, toWorld);
        for (const int child : node.children) addNode(child, toWorld);
    }

    tinygltf::Model model_;
};

class TinyGltfAgreement : public testing::TestWithParam<const char*> {};

TEST_P(TinyGltfAgreement, FindsTheSameSurface) {
    const std::filesystem::path path = std::filesystem::path(TILEFARM_SOURCE_DIR) / GetParam();
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data";
    const SurfaceSums ours = ofOurs(path), theirs = TinyGltfSums(path).sums;
    ASSERT_GT(theirs.area, 0);
    EXPECT_NEAR(ours.area / theirs.area, 1, 1e-5);
    const double size = std::sqrt(theirs.area);
    EXPECT_LT(glm::length(ours.moment / ours.area - theirs.moment / theirs.area) / size, 1e-5);
}

// Files with float positions and triangle lists, without instancing or compression: what tinygltf decodes by
// itself.
INSTANTIATE_TEST_SUITE_P(Files, TinyGltfAgreement,
                         testing::Values("tests/data/demo/demo.glb", "tests/data/cornell.gltf",
                                         "tests/data/furnace.glb",
                                         "../shared/scenes/damaged-helmet/DamagedHelmet.glb",
                                         "../shared/scenes/bathroom/LAZIENKA.gltf",
                                         "../shared/scenes/cornell-box/CornellBox.glb",
                                         "../shared/scenes/khronos-16_volume/16_volume.gltf",
                                         "../shared/scenes/khronos-20_specular/20_specular.gltf",
                                         "../shared/scenes/khronos-25_anisotropy/25_anisotropy.gltf"));

}  // namespace
}  // namespace tilefarm
