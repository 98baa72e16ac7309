#include "worker/scene/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "shared/error/error.h"
#include "worker/scene/limits.h"
#include "worker/scene/mesh_repair.h"

namespace tilefarm {
namespace {

glm::dvec3 transformPoint(const glm::dmat4& m, glm::dvec3 p) {
    return glm::dvec3(m * glm::dvec4(p, 1.0));
}

bool fitsFloat(glm::dvec3 p) {
    constexpr double max = std::numeric_limits<float>::max();
    return std::abs(p.x) <= max && std::abs(p.y) <= max && std::abs(p.z) <= max;
}

/// A square of half sides u and v, its front towards u × v.
Shape shapeOf(const AreaLight& light) {
    Shape shape;
    shape.name = light.name;
    shape.toWorld[3] = glm::dvec4(light.position, 1);
    if (light.shape == AreaShape::sphere) {
        shape.size = glm::dvec3(light.radius);
        return shape;
    }
    shape.kind = ShapeKind::rectangle;
    const glm::dvec3 normal = glm::cross(light.u, light.v);
    const double length = glm::length(normal);
    const double size =
        std::sqrt(length);  // as long as the sides, so that the matrix is no worse than they are
    shape.toWorld[0] = glm::dvec4(light.u, 0);
    shape.toWorld[1] = glm::dvec4(light.v, 0);
    shape.toWorld[2] = glm::dvec4(length > 0 ? normal * (size / length) : normal, 0);
    return shape;
}

Material materialOf(const AreaLight& light) {
    Material material;
    material.name = light.name;
    material.baseColor = glm::vec3(0);
    material.metallic = 0;
    material.roughness = 1;
    material.ior = 1;
    material.emission = light.radiance;
    // A sphere glows inwards as well, so that a point within it is lit as its surroundings say.
    material.doubleSided = light.shape == AreaShape::sphere || light.twoSided;
    return material;
}

/// A wall as thick as the material says, met at right angles.
Material thinned(Material m) {
    glm::vec3 left(1);
    if (std::isfinite(m.attenuationDistance))
        left = glm::pow(m.attenuationColor, glm::vec3(m.thickness / m.attenuationDistance));
    if (m.transmission > 0) m.baseColor *= left;
    m.diffuseTransmissionColor *= left;
    m.thickness = 0;
    return m;
}

/// Near the middle of the bounds, on a grid about as coarse as they are wide: the coordinates left are at
/// most as large as the scene, and a scene around its origin is not moved at all.
glm::dvec3 chooseCentre(const Scene& scene) {
    glm::dvec3 lower(std::numeric_limits<double>::infinity()), upper = -lower;
    for (const Instance& instance : scene.instances) {
        for (glm::vec3 position : scene.meshes[instance.mesh].positions) {
            const glm::dvec3 p = transformPoint(instance.toWorld, position);
            if (fitsFloat(p)) {
                lower = glm::min(lower, p);
                upper = glm::max(upper, p);
            }
        }
    }
    const auto include = [&](const Shape& shape) {
        const ShapeBounds bounds = boundsOf(shape);
        if (!isProper(shape) || !fitsFloat(bounds.lower) || !fitsFloat(bounds.upper)) return;
        lower = glm::min(lower, bounds.lower);
        upper = glm::max(upper, bounds.upper);
    };
    for (const Shape& shape : scene.shapes) include(shape);
    for (const AreaLight& light : scene.areaLights) include(shapeOf(light));
    const glm::dvec3 extent = upper - lower;
    const double widest = std::max({extent.x, extent.y, extent.z});
    if (!(widest > 0) || !std::isfinite(widest)) {
        return fitsFloat(lower) ? lower : glm::dvec3(0);
    }
    const double grid = std::exp2(std::floor(std::log2(widest)) + 1);
    return glm::round((lower + upper) * (0.5 / grid)) * grid;
}

/// Matrix that takes normals along: the inverse transpose up to a positive factor. The cofactors exist for
/// singular matrices too.
glm::dmat3 normalMatrix(const glm::dmat3& m) {
    const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

/// Copies one instance after the other into the arrays.
class Flattener {
public:
    explicit Flattener(const Scene& scene) : scene_(scene) { out_.centre = chooseCentre(scene); }

    WorldGeometry run() {
        reserve();
        for (const Instance& instance : scene_.instances) {
            add(instance);
        }
        addShapes();
        for (PunctualLight light : scene_.lights) {
            light.position -= out_.centre;
            out_.lights.push_back(light);
        }
        if (out_.primitiveCount() > 0) {
            out_.lower = lower_;
            out_.upper = upper_;
        }
        return std::move(out_);
    }

private:
    void reserve() {
        uint64_t vertices = 4 * scene_.areaLights.size(), triangles = 2 * scene_.areaLights.size();
        for (const Instance& instance : scene_.instances) {
            const Mesh& mesh = scene_.meshes[instance.mesh];
            vertices += mesh.positions.size();
            triangles += mesh.triangles.size();
            hasNormals_ |= !mesh.normals.empty();
            hasTangents_ |= !mesh.tangents.empty();
            hasUv0_ |= !mesh.uv0.empty();
            hasUv1_ |= !mesh.uv1.empty();
            hasColors_ |= !mesh.colors.empty();
        }
        if (triangles > kMaxWorldTriangles || vertices >= kNone) {
            throw Error(
                ErrorCode::invalidArgument,
                fmt::format(
                    "the scene has {} triangles and {} vertices with all instances, at most {} and {} "
                    "can be rendered",
                    triangles, vertices, kMaxWorldTriangles, kNone - 1));
        }
        out_.positions.reserve(vertices);
        out_.triangles.reserve(triangles);
        out_.triangleInstance.reserve(triangles);
        out_.triangleInMesh.reserve(triangles);
    }

    void add(const Instance& instance) {
        const Mesh& mesh = scene_.meshes[instance.mesh];
        WorldInstance range;
        range.mesh = instance.mesh;
        range.material = mesh.open ? withoutInside(mesh.material) : mesh.material;
        range.firstVertex = static_cast<uint32_t>(out_.positions.size());
        range.vertexCount = static_cast<uint32_t>(mesh.positions.size());
        range.firstTriangle = out_.triangleCount();
        range.mirrored = glm::determinant(glm::dmat3(instance.toWorld)) < 0;
        addPositions(mesh, instance.toWorld);
        addDirections(mesh, glm::dmat3(instance.toWorld), range.mirrored);
        addSurface(mesh);
        addTriangles(mesh, range, scene_.materials[mesh.material].emission != glm::vec3(0));
        range.triangleCount = out_.triangleCount() - range.firstTriangle;
        out_.instances.push_back(range);
    }

    /// The material itself where it is no solid.
    uint32_t withoutInside(uint32_t material) {
        if (!isSolid(scene_.materials[material])) return material;
        std::vector<ThinMaterial>& thin = out_.thinMaterials;
        const auto same = [material](const ThinMaterial& t) { return t.of == material; };
        const auto known = std::find_if(thin.begin(), thin.end(), same);
        const auto index = static_cast<uint32_t>(scene_.materials.size() + scene_.areaLights.size() +
                                                 static_cast<size_t>(known - thin.begin()));
        if (known == thin.end()) thin.push_back({material, thinned(scene_.materials[material])});
        return index;
    }

    void addShapes() {
        for (Shape shape : scene_.shapes) {
            if (isFlat(shape.kind)) shape.material = withoutInside(shape.material);
            addShape(std::move(shape), kNone);
        }
        for (uint32_t i = 0; i < scene_.areaLights.size(); ++i) {
            const AreaLight& light = scene_.areaLights[i];
            const auto material = static_cast<uint32_t>(scene_.materials.size() + i);
            out_.lightMaterials.push_back(materialOf(light));
            if (light.shape == AreaShape::quad) {
                addQuad(light, material);
                continue;
            }
            Shape shape = shapeOf(light);
            shape.material = material;
            addShape(shape, i);
        }
    }

    void addShape(Shape shape, uint32_t areaLight) {
        shape.toWorld[3] -= glm::dvec4(out_.centre, 0.0);
        const ShapeBounds bounds = boundsOf(shape);
        if (!isProper(shape) || !fitsFloat(bounds.lower) || !fitsFloat(bounds.upper)) {
            ++out_.degenerateShapes;
            return;
        }
        // Some roundings of a coordinate: of the box, and of what the kernel makes of the shape.
        const glm::dvec3 slack = 0x1p-21 * (glm::max(glm::abs(bounds.lower), glm::abs(bounds.upper)) +
                                            glm::length(bounds.upper - bounds.lower));
        WorldShape world{shape, bounds.lower - slack, bounds.upper + slack, areaLight};
        lower_ = glm::min(lower_, world.lower);
        upper_ = glm::max(upper_, world.upper);
        out_.shapes.push_back(std::move(world));
    }

    void addPositions(const Mesh& mesh, const glm::dmat4& toWorld) {
        for (glm::vec3 position : mesh.positions) {
            addPosition(transformPoint(toWorld, position) - out_.centre);
        }
    }

    void addPosition(const glm::dvec3& p) {
        out_.positions.push_back(fitsFloat(p) ? glm::vec3(p)
                                              : glm::vec3(std::numeric_limits<float>::infinity()));
    }

    void addDirections(const Mesh& mesh, const glm::dmat3& toWorld, bool mirrored) {
        const size_t count = out_.positions.size();
        const glm::dmat3 forNormals = normalMatrix(toWorld);
        if (hasNormals_) {
            for (glm::vec3 normal : mesh.normals) {
                out_.normals.emplace_back(normalizeOrZero(forNormals * glm::dvec3(normal)));
            }
            out_.normals.resize(count, glm::vec3(0));
        }
        if (hasTangents_) {
            for (size_t i = 0; i < mesh.tangents.size(); ++i) {
                const glm::dvec3 normal = mesh.normals.empty()
                                              ? glm::dvec3(0)
                                              : normalizeOrZero(forNormals * glm::dvec3(mesh.normals[i]));
                out_.tangents.push_back(worldTangent(mesh.tangents[i], normal, toWorld, mirrored));
            }
            out_.tangents.resize(count, glm::vec4(0));
        }
    }

    static glm::vec4 worldTangent(glm::vec4 tangent, glm::dvec3 normal, const glm::dmat3& toWorld,
                                  bool mirrored) {
        glm::dvec3 t = normalizeOrZero(toWorld * glm::dvec3(tangent));
        t = normalizeOrZero(t - normal * glm::dot(normal, t));
        if (t == glm::dvec3(0)) {
            return glm::vec4(0);
        }
        // cross(normal, tangent) turns round when space is mirrored.
        return glm::vec4(glm::vec3(t), mirrored ? -tangent.w : tangent.w);
    }

    /// Attributes that no transform changes.
    void addSurface(const Mesh& mesh) {
        const size_t count = out_.positions.size();
        const auto append = [count](auto& out, const auto& in, auto absent) {
            out.insert(out.end(), in.begin(), in.end());
            out.resize(count, absent);
        };
        if (hasUv0_) append(out_.uv0, mesh.uv0, glm::vec2(0));
        if (hasUv1_) append(out_.uv1, mesh.uv1, glm::vec2(0));
        if (hasColors_) append(out_.colors, mesh.colors, glm::vec4(1));
    }

    void addTriangles(const Mesh& mesh, const WorldInstance& range, bool emissive) {
        const uint32_t instance = static_cast<uint32_t>(out_.instances.size());
        for (size_t i = 0; i < mesh.triangles.size(); ++i) {
            glm::uvec3 corners = mesh.triangles[i] + range.firstVertex;
            if (range.mirrored) {
                std::swap(corners.y, corners.z);
            }
            const double area = areaOf(corners);
            if (!(area > 0) || !std::isfinite(area)) {
                ++out_.degenerateTriangles;
                continue;
            }
            if (emissive) {
                out_.emissive.push_back({out_.triangleCount(), area});
            }
            for (int k = 0; k < 3; ++k) {
                lower_ = glm::min(lower_, out_.positions[corners[k]]);
                upper_ = glm::max(upper_, out_.positions[corners[k]]);
            }
            out_.triangles.push_back(corners);
            out_.triangleInstance.push_back(instance);
            out_.triangleInMesh.push_back(static_cast<uint32_t>(i));
        }
    }

    /// A rectangle becomes two triangles and a light of its own; a skewed one two triangles that emit.
    void addQuad(const AreaLight& light, uint32_t material) {
        Mesh mesh;
        const glm::dvec3 corner = light.position - light.u - light.v - out_.centre;
        for (const glm::dvec3& p : {corner, corner + 2.0 * light.u, corner + 2.0 * (light.u + light.v),
                                    corner + 2.0 * light.v}) {
            addPosition(p);
        }
        addDirections(mesh, glm::dmat3(1), false);  // has none of these: only keeps the arrays as long
        addSurface(mesh);
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};

        WorldInstance range;
        range.mesh = kNone;
        range.material = material;
        range.firstVertex = static_cast<uint32_t>(out_.positions.size() - 4);
        range.vertexCount = 4;
        range.firstTriangle = out_.triangleCount();
        // Beyond 1e-5 the density of the rectangle's sampling would be off by more than its rounding.
        const bool skewed = std::abs(glm::dot(light.u, light.v)) > 1e-5 * glm::length(light.u) * glm::length(light.v);
        addTriangles(mesh, range, skewed && light.radiance != glm::vec3(0));
        range.triangleCount = out_.triangleCount() - range.firstTriangle;
        out_.instances.push_back(range);
        // Where rounding took one of the triangles, the other emits by itself.
        if (!skewed && range.triangleCount == 1 && light.radiance != glm::vec3(0))
            out_.emissive.push_back({range.firstTriangle, areaOf(out_.triangles[range.firstTriangle])});
        if (skewed || range.triangleCount != 2) return;
        const glm::vec3* p = &out_.positions[range.firstVertex];
        out_.quads.push_back(
            {range.firstTriangle, p[0], p[1] - p[0], p[3] - p[0], light.radiance, light.twoSided});
    }

    /// Of the rounded corners, so that it is the area of what rays meet.
    double areaOf(glm::uvec3 t) const {
        const glm::dvec3 a(out_.positions[t.x]), b(out_.positions[t.y]), c(out_.positions[t.z]);
        return 0.5 * glm::length(glm::cross(b - a, c - a));
    }

    const Scene& scene_;
    WorldGeometry out_;
    glm::vec3 lower_{std::numeric_limits<float>::infinity()}, upper_{-std::numeric_limits<float>::infinity()};
    bool hasNormals_ = false, hasTangents_ = false, hasUv0_ = false, hasUv1_ = false, hasColors_ = false;
};

}  // namespace

std::vector<glm::vec3> WorldGeometry::corners() const {
    std::vector<glm::vec3> result;
    result.reserve(triangles.size() * 3);
    for (glm::uvec3 t : triangles) {
        result.insert(result.end(), {positions[t.x], positions[t.y], positions[t.z]});
    }
    return result;
}

Camera WorldGeometry::recentred(const Camera& camera) const {
    Camera moved = camera;
    moved.toWorld[3] -= glm::dvec4(centre, 0.0);
    return moved;
}

WorldGeometry flatten(const Scene& scene) {
    return Flattener(scene).run();
}

}  // namespace tilefarm
