#include "worker/scene/view_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

namespace tilefarm {
namespace {

constexpr int kGrid = 48;        // rays per side of a look at the picture
constexpr double kRound = 1e-6;  // depths are of rounded corners

using Triangle = std::array<glm::dvec3, 3>;

/// A camera whose picture is −1 … 1 along x and y; z is the depth along the view direction.
class Frame {
public:
    Frame(const Camera& camera, double aspect)
        : eye_(camera.toWorld[3]),
          right_(glm::normalize(glm::dvec3(camera.toWorld[0]))),
          up_(glm::normalize(glm::dvec3(camera.toWorld[1]))),
          forward_(-glm::normalize(glm::dvec3(camera.toWorld[2]))),
          halfHeight_(camera.orthographic ? double{camera.ymag} : std::tan(0.5 * camera.yfov)),
          halfWidth_(halfHeight_ * aspect),
          flat_(camera.orthographic) {}

    glm::dvec3 seen(const glm::dvec3& p) const {
        const glm::dvec3 d = p - eye_;
        return {glm::dot(d, right_) / halfWidth_, glm::dot(d, up_) / halfHeight_, glm::dot(d, forward_)};
    }
    Triangle seen(const Triangle& t) const { return {seen(t[0]), seen(t[1]), seen(t[2])}; }
    /// What the distance from the middle of the picture is compared with at a depth.
    double reach(double depth) const { return flat_ ? 1 : depth; }

    /// The depth where the ray through a place of the picture meets a seen triangle, and whether from behind.
    std::optional<std::pair<double, bool>> meets(const Triangle& t, double x, double y) const {
        // In the picture's own space rays are (x, y, 0) + s (0, 0, 1), or s (x, y, 1).
        const glm::dvec3 from = flat_ ? glm::dvec3(x, y, 0) : glm::dvec3(0);
        const glm::dvec3 along = flat_ ? glm::dvec3(0, 0, 1) : glm::dvec3(x, y, 1);
        const glm::dvec3 e1 = t[1] - t[0], e2 = t[2] - t[0], p = glm::cross(along, e2), o = from - t[0];
        const double determinant = glm::dot(e1, p);
        if (determinant == 0) return std::nullopt;
        const double u = glm::dot(o, p) / determinant;
        const glm::dvec3 q = glm::cross(o, e1);
        const double v = glm::dot(along, q) / determinant, s = glm::dot(e2, q) / determinant;
        if (!(u >= 0 && v >= 0 && u + v <= 1 && s > 0)) return std::nullopt;
        // Depth grows away from the camera: the space is left-handed, and fronts have a negative determinant.
        return std::pair(s, determinant > 0);
    }

private:
    glm::dvec3 eye_, right_, up_, forward_;
    double halfHeight_, halfWidth_;
    bool flat_;
};

struct Depths {
    double nearest = INFINITY, farthest = -INFINITY;
};

/// Depths of the part of a seen triangle that is in the picture (Sutherland, Hodgman 1974).
Depths depthsInPicture(const Frame& frame, const Triangle& triangle) {
    std::vector<glm::dvec3> polygon(triangle.begin(), triangle.end());
    const auto clip = [&](auto inside) {
        std::vector<glm::dvec3> kept;
        for (size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
            const double da = inside(a), db = inside(b);
            if (da >= 0) kept.push_back(a);
            if ((da < 0) != (db < 0)) kept.push_back(a + (b - a) * (da / (da - db)));
        }
        polygon = std::move(kept);
    };
    clip([](const glm::dvec3& p) { return p.z; });
    for (const int axis : {0, 1})
        for (const double side : {-1.0, 1.0})
            clip([&](const glm::dvec3& p) { return frame.reach(p.z) - side * p[axis]; });
    Depths depths;
    for (const glm::dvec3& p : polygon) {
        depths.nearest = std::min(depths.nearest, p.z);
        depths.farthest = std::max(depths.farthest, p.z);
    }
    return depths;
}

/// The twelve triangles around a shape.
std::vector<Triangle> boxOf(const WorldShape& shape) {
    const auto corner = [&](int i) {
        return glm::dvec3(i & 1 ? shape.upper.x : shape.lower.x, i & 2 ? shape.upper.y : shape.lower.y,
                          i & 4 ? shape.upper.z : shape.lower.z);
    };
    std::vector<Triangle> triangles;
    for (const int axis : {1, 2, 4})
        for (const int side : {0, axis}) {
            const int a = axis == 4 ? 1 : axis * 2, b = 7 - axis - a;
            triangles.push_back({corner(side), corner(side + a), corner(side + b)});
            triangles.push_back({corner(side + a), corner(side + a + b), corner(side + b)});
        }
    return triangles;
}

/// What lies outside of the clipping planes: where, and how far.
struct Outside {
    std::string node;
    double depth = 0;
};

class ClippingCheck {
public:
    ClippingCheck(const Frame& frame, const Camera& camera) : frame_(frame), camera_(camera) {}

    void add(const Triangle& seen, const std::string& node) {
        const auto [low, high] = std::minmax({seen[0].z, seen[1].z, seen[2].z});
        if ((low >= least() || high <= 0) && high <= most()) return;
        const Depths depths = depthsInPicture(frame_, seen);
        if (depths.nearest < least() && (!before || depths.nearest < before->depth))
            before = {node, depths.nearest};
        if (depths.farthest > most() && (!beyond || depths.farthest > beyond->depth))
            beyond = {node, depths.farthest};
    }

    std::optional<Outside> before, beyond;

private:
    double least() const { return camera_.znear * (1 - kRound); }
    double most() const { return camera_.zfar * (1 + kRound); }
    const Frame& frame_;
    const Camera& camera_;
};

const std::string& nodeOf(const Scene& scene, size_t instance) {
    static const std::string light = "light";  // area lights follow the scene's instances
    return instance < scene.instances.size() ? scene.instances[instance].node : light;
}

Triangle cornersOf(const WorldGeometry& world, uint32_t triangle) {
    const glm::uvec3 t = world.triangles[triangle];
    return {world.positions[t.x], world.positions[t.y], world.positions[t.z]};
}

std::vector<SceneWarning> clippingWarnings(const Scene& scene, const WorldGeometry& world,
                                           const Camera& camera, double aspect) {
    if (camera.clips || camera.panorama || (camera.znear <= 0 && std::isinf(camera.zfar))) return {};
    const Frame frame(camera, aspect);
    ClippingCheck check(frame, camera);
    for (uint32_t t = 0; t < world.triangleCount(); ++t)
        check.add(frame.seen(cornersOf(world, t)), nodeOf(scene, world.triangleInstance[t]));
    for (const WorldShape& shape : world.shapes)
        for (const Triangle& triangle : boxOf(shape)) check.add(frame.seen(triangle), shape.shape.name);
    std::vector<SceneWarning> warnings;
    const auto warn = [&](const char* plane, double at, const std::optional<Outside>& outside,
                          const char* side) {
        if (!outside) return;
        warnings.push_back(
            {plane, fmt::format("camera {}", camera.name),
             fmt::format("is {:.6g} m and what lies {} it, like node {} at {:.6g} m, is rendered; "
                         "settings.cameraClip leaves it out",
                         at, side, outside->node, outside->depth)});
    };
    warn("znear", camera.znear, check.before, "before");
    warn("zfar", camera.zfar, check.beyond, "beyond");
    return warnings;
}

/// What the rays of a grid over the picture meet first: a look too coarse to miss anything that matters.
class Look {
public:
    Look(const Frame& frame, const Camera& camera) : frame_(frame), camera_(camera) {}

    void add(const Triangle& seen, uint32_t material, bool cullable) {
        int low[2] = {0, 0}, high[2] = {kGrid - 1, kGrid - 1};
        if (std::max({seen[0].z, seen[1].z, seen[2].z}) <= 0) return;
        if (std::min({seen[0].z, seen[1].z, seen[2].z}) > 0)
            for (const int axis : {0, 1}) {
                const auto at = [&](int i) { return seen[i][axis] / frame_.reach(seen[i].z); };
                const auto [least, most] = std::minmax({at(0), at(1), at(2)});
                low[axis] = std::max(0, static_cast<int>(std::floor(std::clamp(cellOf(least), -1.0, 1e6))));
                high[axis] =
                    std::min(kGrid - 1, static_cast<int>(std::ceil(std::clamp(cellOf(most), -1.0, 1e6))));
            }
        for (int y = low[1]; y <= high[1]; ++y)
            for (int x = low[0]; x <= high[0]; ++x) meet(seen, material, cullable, x, y);
    }

    /// Parts of the picture, by material.
    std::map<uint32_t, double> backs() const {
        std::map<uint32_t, double> parts;
        for (const First& first : first_)
            if (first.culled) parts[first.material] += 1.0 / (kGrid * kGrid);
        return parts;
    }

private:
    struct First {
        double depth = INFINITY;
        uint32_t material = 0;
        bool culled = false;
    };
    static double cellOf(double place) { return 0.5 * (place + 1) * kGrid - 0.5; }
    static double placeOf(int cell) { return 2 * (cell + 0.5) / kGrid - 1; }

    void meet(const Triangle& seen, uint32_t material, bool cullable, int x, int y) {
        First& first = first_[static_cast<size_t>(y * kGrid + x)];
        const auto met = frame_.meets(seen, placeOf(x), placeOf(y));
        if (!met || met->first >= first.depth) return;
        if (camera_.clips && (met->first < camera_.znear || met->first > camera_.zfar)) return;
        first = {met->first, material, met->second && cullable};
    }

    const Frame& frame_;
    const Camera& camera_;
    std::array<First, size_t{kGrid} * kGrid> first_;
};

std::string labelOf(const Scene& scene, uint32_t material) {
    const std::string& name = scene.materials[material].name;
    return name.empty() ? fmt::format("materials/{}", material)
                        : fmt::format("materials/{} ({})", material, name);
}

std::vector<SceneWarning> cullingWarnings(const Scene& scene, const WorldGeometry& world,
                                          const Camera& camera, double aspect, Culling culling) {
    const Frame frame(camera, aspect);
    Look look(frame, camera);
    for (size_t i = 0; i < world.instances.size(); ++i) {
        const WorldInstance& instance = world.instances[i];
        const bool cullable = isCullable(scene, instance);
        for (uint32_t t = 0; t < instance.triangleCount; ++t)
            look.add(frame.seen(cornersOf(world, instance.firstTriangle + t)), instance.material, cullable);
    }
    std::vector<SceneWarning> warnings;
    for (const auto& [material, part] : look.backs())
        warnings.push_back(
            {"doubleSided", labelOf(scene, material),
             fmt::format(
                 "is false, so the camera does not see its back, which would fill about {:.0f} % of the "
                 "picture; {} (settings.culling)",
                 std::max(100 * part, 1.0),
                 culling == Culling::all ? "no ray does" : "light and reflections meet it all the same")});
    return warnings;
}

}  // namespace

std::vector<SceneWarning> viewWarnings(const Scene& scene, const WorldGeometry& world, const Camera& camera,
                                       double imageAspect, const BackFaces& backFaces, Culling culling) {
    std::vector<SceneWarning> warnings = clippingWarnings(scene, world, camera, imageAspect);
    const bool culls = culling != Culling::none && !camera.panorama;
    if (!culls || !backFaces.mayBeSeen({{camera}, std::nullopt})) return warnings;
    const std::vector<SceneWarning> more = cullingWarnings(scene, world, camera, imageAspect, culling);
    warnings.insert(warnings.end(), more.begin(), more.end());
    return warnings;
}

}  // namespace tilefarm
