#include "worker/scene/tangents.h"

#include <gtest/gtest.h>

#include <numbers>

#include "worker/scene/mikktspace.h"

namespace tilefarm {
namespace {

constexpr double kPi = std::numbers::pi;

TextureRef normalMap() {
    TextureRef ref;
    ref.image = 0;
    return ref;
}

/// A unit square facing +z; u to the right and v down, as images lie in glTF.
Mesh square() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.uv0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

TEST(Tangents, FollowUAndPointTheBitangentUpInTheImage) {
    Mesh mesh = square();
    generateTangents(mesh, normalMap());
    ASSERT_EQ(mesh.positions.size(), 4u);
    for (glm::vec4 tangent : mesh.tangents) {
        EXPECT_EQ(tangent, glm::vec4(1, 0, 0, 1));
    }
}

TEST(Tangents, ReadTextureCoordinatesAsTheNormalMapDoes) {
    Mesh mesh = square();
    mesh.uv1 = mesh.uv0;
    mesh.uv0.clear();
    TextureRef ref = normalMap();
    ref.uvSet = 1;
    ref.transform = glm::mat3x2(0, -1, 1, 0, 0, 0);  // u' = v, v' = -u
    generateTangents(mesh, ref);
    for (glm::vec4 tangent : mesh.tangents) {
        EXPECT_EQ(tangent, glm::vec4(0, -1, 0, 1));
    }
}

TEST(Tangents, SplitVerticesWhereTextureSpaceIsMirrored) {
    // Two squares side by side whose u runs towards the seam from both sides.
    Mesh mesh;
    mesh.positions = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
    mesh.normals.assign(6, {0, 0, 1});
    mesh.uv0 = {{0, 1}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {0, 0}};
    mesh.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    generateTangents(mesh, normalMap());
    EXPECT_EQ(mesh.positions.size(), 8u) << "both vertices of the seam are split";
    for (size_t t = 0; t < 4; ++t) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(mesh.tangents[mesh.triangles[t][k]],
                      t < 2 ? glm::vec4(1, 0, 0, 1) : glm::vec4(-1, 0, 0, -1));
        }
    }
}

TEST(Tangents, WeightTrianglesByTheirAngle) {
    // At vertex 0 a triangle of 90 degrees with +u along +x meets one of 45 degrees with +u along +x+y, both
    // in one orientation. Closed form: (90 * (1,0) + 45 * (1,1)/sqrt 2), normalised.
    const std::vector<glm::vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}};
    const std::vector<glm::vec3> normals(4, {0, 0, 1});
    // The first triangle's map is (x, y); the second shares vertices 0 and 2 and turns by 45 degrees and
    // scales.
    const std::vector<glm::vec2> uvs{{0, 0}, {1, 0}, {0, 1}, {-1, 0}};
    const std::vector<glm::uvec3> triangles{{0, 1, 2}, {0, 2, 3}};
    const auto tangents = mikkTangents(positions, normals, uvs, triangles);
    // In the second triangle: edges (0,1) -> uv (0,1) and (-1,1) -> uv (-1,0), so +u is (1,-1).
    const glm::dvec2 sum = 90.0 * glm::dvec2(1, 0) + 45.0 * glm::normalize(glm::dvec2(1, -1));
    const glm::dvec2 expected = glm::normalize(sum);
    for (size_t corner : {0u, 3u}) {
        EXPECT_NEAR(tangents[corner].x, expected.x, 1e-6);
        EXPECT_NEAR(tangents[corner].y, expected.y, 1e-6);
        EXPECT_EQ(tangents[corner].w, 1);
    }
    EXPECT_EQ(tangents[1], glm::vec4(1, 0, 0, 1)) << "vertex 1 belongs to the first triangle alone";
}

TEST(Tangents, ShareAVertexOnlyAcrossEdges) {
    // Two triangles that touch in one point keep their own tangents there.
    const std::vector<glm::vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    const std::vector<glm::vec3> normals(5, {0, 0, 1});
    const std::vector<glm::vec2> uvs{{0, 0}, {1, 0}, {0, 1}, {0, -1}, {1, 0}};
    const std::vector<glm::uvec3> triangles{{0, 1, 2}, {0, 3, 4}};
    const auto tangents = mikkTangents(positions, normals, uvs, triangles);
    EXPECT_EQ(glm::vec3(tangents[0]), glm::vec3(1, 0, 0));
    EXPECT_EQ(glm::vec3(tangents[3]), glm::vec3(0, -1, 0));
}

TEST(Tangents, DoNotDependOnHowVerticesAreShared) {
    Mesh shared = square();
    shared.normals = {{0, 0, 1}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}, {0, 0, 1}};
    shared.uv0[2] = {0.7f, 0.2f};
    Mesh split = shared;
    split.positions.clear();
    split.normals.clear();
    split.uv0.clear();
    for (glm::uvec3& t : split.triangles) {
        for (int k = 0; k < 3; ++k) {
            split.positions.push_back(shared.positions[t[k]]);
            split.normals.push_back(shared.normals[t[k]]);
            split.uv0.push_back(shared.uv0[t[k]]);
            t[k] = static_cast<uint32_t>(split.positions.size() - 1);
        }
    }
    generateTangents(shared, normalMap());
    generateTangents(split, normalMap());
    for (size_t t = 0; t < 2; ++t) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(shared.tangents[shared.triangles[t][k]], split.tangents[split.triangles[t][k]]);
        }
    }
}

TEST(Tangents, OfASphereFollowItsParallels) {
    // Longitude is u, so the tangent is the derivative of the position by longitude.
    constexpr int columns = 64, rows = 32;
    Mesh mesh;
    for (int r = 0; r <= rows; ++r) {
        for (int c = 0; c <= columns; ++c) {
            const double theta = kPi * r / rows, phi = 2 * kPi * c / columns;
            const glm::dvec3 p(std::sin(theta) * std::cos(phi), std::cos(theta),
                               -std::sin(theta) * std::sin(phi));
            mesh.positions.emplace_back(p);
            mesh.normals.emplace_back(p);
            mesh.uv0.emplace_back(double(c) / columns, double(r) / rows);
        }
    }
    for (uint32_t r = 1; r + 1 < rows; ++r) {
        for (uint32_t c = 0; c < columns; ++c) {
            const uint32_t a = r * (columns + 1) + c, b = a + 1, d = a + columns + 1;
            mesh.triangles.insert(mesh.triangles.end(), {{a, d, b}, {b, d, d + 1}});
        }
    }
    generateTangents(mesh, normalMap());
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        const double row = std::floor(double(i) / (columns + 1));
        if (row < 3 || row > rows - 3 || i >= size_t{(rows + 1) * (columns + 1)}) {
            continue;
        }
        const double phi = 2 * kPi * double(i % (columns + 1)) / columns;
        const glm::dvec3 expected(-std::sin(phi), 0, -std::cos(phi));
        EXPECT_GT(glm::dot(glm::dvec3(mesh.tangents[i]), expected), 0.995) << i;
        EXPECT_NEAR(glm::dot(glm::dvec3(mesh.tangents[i]), glm::dvec3(mesh.normals[i])), 0, 1e-6);
        EXPECT_EQ(mesh.tangents[i].w, 1);
    }
}

TEST(Tangents, AreSomethingUsableWhereTextureCoordinatesAreNot) {
    for (glm::vec2 uv : {glm::vec2(0), glm::vec2(std::numeric_limits<float>::infinity())}) {
        Mesh mesh = square();
        mesh.uv0.assign(4, uv);
        generateTangents(mesh, normalMap());
        for (glm::vec4 t : mesh.tangents) {
            EXPECT_NEAR(glm::length(glm::vec3(t)), 1, 1e-6);
            EXPECT_NEAR(t.z, 0, 1e-6);
            EXPECT_EQ(t.w, 1);
        }
    }
}

TEST(Tangents, TrianglesWithoutDirectionTakeTheirNeighbours) {
    Mesh mesh = square();
    mesh.uv0[3] = mesh.uv0[2];  // the second triangle's texture coordinates lie on a line
    generateTangents(mesh, normalMap());
    for (int k = 0; k < 2; ++k) {
        EXPECT_EQ(mesh.tangents[mesh.triangles[1][k]], glm::vec4(1, 0, 0, 1));
    }
}

TEST(Tangents, OfFilesAreMadeOrthonormal) {
    Mesh mesh = square();
    mesh.tangents = {
        {2, 0, 1, 1}, {0, 0, 0, -1}, {0, 0, 5, 1}, {std::numeric_limits<float>::quiet_NaN(), 0, 0, 0}};
    repairTangents(mesh);
    EXPECT_EQ(mesh.tangents[0], glm::vec4(1, 0, 0, 1));
    for (int i = 1; i < 4; ++i) {
        EXPECT_NEAR(glm::length(glm::vec3(mesh.tangents[size_t(i)])), 1, 1e-6);
        EXPECT_NEAR(mesh.tangents[size_t(i)].z, 0, 1e-6);
    }
    EXPECT_EQ(mesh.tangents[1].w, -1);
}

TEST(Tangents, StayQuickWhereAllTrianglesMeetInOneVertexOrEdge) {
    // Would take minutes if either the search for neighbours or the splitting were quadratic.
    constexpr uint32_t count = 100000;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}};
    mesh.uv0 = {{0, 0}, {1, 0}};
    for (uint32_t i = 0; i < count; ++i) {
        mesh.positions.emplace_back(0.5f, 1, 1e-3f * float(i));
        mesh.uv0.emplace_back(1e-4f * float(i), 1);
        mesh.triangles.emplace_back(0, 1, 2 + i);
    }
    mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
    generateTangents(mesh, normalMap());
    EXPECT_EQ(mesh.tangents.size(), mesh.positions.size());
}

}  // namespace
}  // namespace tilefarm
