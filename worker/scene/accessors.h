#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "worker/scene/buffer_views.h"

namespace tilefarm {

enum class ComponentType : uint32_t { i8 = 5120, u8, i16, u16, u32 = 5125, f32 };

/// How the elements of an accessor lie in their buffer view.
struct Accessor {
    struct Sparse {
        uint32_t count = 0;
        uint32_t indexView = 0, valueView = 0;
        uint64_t indexOffset = 0, valueOffset = 0;
        ComponentType indexType = ComponentType::u32;
    };
    uint32_t count = 0;
    uint32_t components = 0;  // 1 … 4, or 4, 9, 16 for matrices
    bool matrix = false;
    ComponentType type = ComponentType::f32;
    bool normalized = false;
    uint32_t elementBytes = 0;
    std::optional<uint32_t> view;  // none: all zero
    uint64_t offset = 0;
    uint32_t stride = 0;
    std::optional<Sparse> sparse;
};

/// The accessors of a glTF file. Construction checks each one against its views, and a broken one is a
/// warning until it is asked for (part_list.h); reading converts to
/// floats (normalised integers as the specification says) or to indices.
class Accessors {
public:
    Accessors(const JsonNode& root, BufferViews& views);

    size_t count() const { return accessors_.size(); }
    const Accessor& operator[](uint32_t index) const { return accessors_[index]; }

    /// What is read without a buffer view behind it is counted from here on, against kMaxUnbackedBytes.
    void beginPose() { unbacked_ = 0; }

    std::vector<float> scalars(uint32_t index);
    std::vector<glm::vec2> vec2s(uint32_t index);
    std::vector<glm::vec3> vec3s(uint32_t index);
    std::vector<glm::vec4> vec4s(uint32_t index);
    /// vec3 elements get `w`.
    std::vector<glm::vec4> vec4s(uint32_t index, float w);
    /// Whatever its type but matrices: count * components numbers.
    std::vector<float> numbers(uint32_t index);
    std::vector<glm::mat4> mat4s(uint32_t index);
    /// Unsigned integers as they are.
    std::vector<uint32_t> integers(uint32_t index);

private:
    Accessor parse(const JsonNode& node) const;
    Accessor::Sparse parseSparse(const JsonNode& node, const Accessor& accessor) const;
    template <typename Element>
    std::vector<Element> read(uint32_t index, uint32_t components);
    void readInto(uint32_t index, float* out);
    void takeUnbacked(uint32_t index);
    void applySparse(uint32_t index, float* out);
    std::vector<uint32_t> sparseIndices(uint32_t index);

    JsonNode nodes_;
    BufferViews& views_;
    PartList<Accessor> accessors_;
    uint64_t unbacked_ = 0;  // bytes read since beginPose()
};

}  // namespace tilefarm
