#pragma once

#include <initializer_list>
#include <optional>
#include <vector>

#include "worker/render/light_packer.h"
#include "worker/render/light_tree.h"

/// What the packers of this folder have in common, one for each kind of light (shaders/tables/lights.py).
namespace tilefarm {

/// Collects records beside what chooses among them.
struct LightList {
    std::vector<gpu::LightRecord> records;
    std::vector<double> powers;
    std::vector<LightBounds> bounds;
    std::vector<uint32_t> groups;  // first light of each

    /// Whether it is a light: it sends out something. `object`: lights of one that follow each other are a group.
    bool add(gpu::LightRecord record, const glm::vec3& value, double power, const LightBounds& bound,
             std::optional<uint64_t> object = std::nullopt);
    uint32_t next() const { return static_cast<uint32_t>(records.size()); }

private:
    std::optional<uint64_t> lastObject_;
};

/// A shape with what it is made of; `primitive` is its number among all.
struct EmissiveShape {
    const Shape& shape;
    const Material& material;
    uint32_t primitive;
};

double luminance(const glm::dvec3& color);

/// Of a flat emitter: Lambert, so the intensity is greatest along the normal.
LightBounds flatBounds(const std::initializer_list<glm::vec3>& corners, const glm::dvec3& normal,
                       double intensity, bool twoSided);

/// Even over the whole surface, whatever way light leaves it.
bool emitsEvenly(const Material& material);

/// Of a shape that emits evenly: what leaves it, on average over what is there and what is not.
glm::vec3 coveredEmission(const Material& material);

}  // namespace tilefarm
