#include "worker/scene/accessors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

#include "worker/scene/limits.h"

namespace tilefarm {
namespace {

struct ElementShape {
    uint32_t components;
    uint32_t columns;  // 1 for scalars and vectors
};

ElementShape parseShape(const JsonNode& node) {
    const std::string& name = node.text();
    if (name == "SCALAR") return {1, 1};
    if (name == "VEC2") return {2, 1};
    if (name == "VEC3") return {3, 1};
    if (name == "VEC4") return {4, 1};
    if (name == "MAT2") return {4, 2};
    if (name == "MAT3") return {9, 3};
    if (name == "MAT4") return {16, 4};
    node.fail(fmt::format("is \"{}\", must be SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4", name));
}

ComponentType parseComponentType(const JsonNode& node) {
    const uint64_t value = node.integer(std::numeric_limits<uint32_t>::max());
    if ((value >= 5120 && value <= 5123) || value == 5125 || value == 5126) {
        return static_cast<ComponentType>(value);
    }
    node.fail(fmt::format("is {}, must be 5120, 5121, 5122, 5123, 5125 or 5126", value));
}

uint32_t sizeOf(ComponentType type) {
    switch (type) {
        case ComponentType::i8:
        case ComponentType::u8: return 1;
        case ComponentType::i16:
        case ComponentType::u16: return 2;
        case ComponentType::u32:
        case ComponentType::f32: return 4;
    }
    return 4;
}

/// Columns of matrices start at multiples of four bytes.
uint32_t elementBytes(ElementShape shape, ComponentType type) {
    const uint32_t column = shape.components / shape.columns * sizeOf(type);
    return shape.columns == 1 ? column : shape.columns * ((column + 3) / 4 * 4);
}

void checkFits(uint64_t offset, uint64_t count, uint64_t stride, uint64_t element, uint64_t available,
               const JsonNode& node) {
    if (count == 0) {
        return;
    }
    // offset < 2^34, count <= 2^31, stride < 2^8: no overflow.
    const uint64_t end = offset + (count - 1) * stride + element;
    if (end > available) {
        node.fail(
            fmt::format("its {} elements end at byte {} of a buffer view of {}", count, end, available));
    }
}

template <typename T>
float toFloat(T value, bool normalized) {
    if constexpr (std::is_floating_point_v<T>) {
        return value;
    } else {
        if (!normalized) {
            return static_cast<float>(value);
        }
        // Exact in double, so that 0 and 1 are hit and the rest rounds once.
        const double scaled = static_cast<double>(value) / std::numeric_limits<T>::max();
        return static_cast<float>(std::max(scaled, -1.0));
    }
}

template <typename T>
void convert(const std::byte* data, uint64_t stride, uint64_t count, uint32_t components, bool normalized,
             float* out) {
    for (uint64_t i = 0; i < count; ++i) {
        for (uint32_t c = 0; c < components; ++c) {
            T value;
            std::memcpy(&value, data + i * stride + c * sizeof(T), sizeof(T));
            *out++ = toFloat(value, normalized);
        }
    }
}

void convert(const Accessor& accessor, const std::byte* data, uint64_t stride, uint64_t count, float* out) {
    const uint32_t components = accessor.components;
    const bool normalized = accessor.normalized;
    switch (accessor.type) {
        case ComponentType::i8: return convert<int8_t>(data, stride, count, components, normalized, out);
        case ComponentType::u8: return convert<uint8_t>(data, stride, count, components, normalized, out);
        case ComponentType::i16: return convert<int16_t>(data, stride, count, components, normalized, out);
        case ComponentType::u16: return convert<uint16_t>(data, stride, count, components, normalized, out);
        case ComponentType::u32: return convert<uint32_t>(data, stride, count, components, normalized, out);
        case ComponentType::f32: return convert<float>(data, stride, count, components, normalized, out);
    }
}

uint32_t readUnsigned(const std::byte* data, ComponentType type) {
    if (type == ComponentType::u8) {
        return std::to_integer<uint32_t>(*data);
    }
    uint32_t value = 0;
    std::memcpy(&value, data, sizeOf(type));  // little endian: the low bytes come first
    return value;
}

bool isUnsigned(ComponentType type) {
    return type == ComponentType::u8 || type == ComponentType::u16 || type == ComponentType::u32;
}

}  // namespace

Accessors::Accessors(const JsonNode& root, BufferViews& views) : nodes_(root["accessors"]), views_(views) {
    for (size_t i = 0; i < nodes_.size(); ++i) {
        accessors_.add(nodes_[i], [&] { return parse(nodes_[i]); });
    }
}

Accessor Accessors::parse(const JsonNode& node) const {
    Accessor accessor;
    const ElementShape shape = parseShape(node["type"]);
    accessor.components = shape.components;
    accessor.matrix = shape.columns > 1;
    accessor.type = parseComponentType(node["componentType"]);
    accessor.normalized = node["normalized"].booleanOr(false);
    accessor.count = static_cast<uint32_t>(node["count"].integer(kMaxElements));
    accessor.elementBytes = elementBytes(shape, accessor.type);
    accessor.stride = accessor.elementBytes;
    accessor.offset = node["byteOffset"].integerOr(0, kMaxBufferBytes);
    if (const JsonNode view = node["bufferView"]) {
        accessor.view = view.index(views_.count(), "/bufferViews");
        if (const uint32_t stride = views_.stride(*accessor.view)) {
            accessor.stride = stride;
        }
        if (accessor.stride < accessor.elementBytes) {
            node.fail(fmt::format("its elements of {} bytes overlap in a buffer view with a stride of {}",
                                  accessor.elementBytes, accessor.stride));
        }
        checkFits(accessor.offset, accessor.count, accessor.stride, accessor.elementBytes,
                  views_.length(*accessor.view), node);
    }
    if (const JsonNode sparse = node["sparse"]) {
        accessor.sparse = parseSparse(sparse, accessor);
    }
    return accessor;
}

Accessor::Sparse Accessors::parseSparse(const JsonNode& node, const Accessor& accessor) const {
    Accessor::Sparse sparse;
    sparse.count = static_cast<uint32_t>(node["count"].integer(accessor.count));
    const JsonNode indices = node["indices"], values = node["values"];
    sparse.indexType = parseComponentType(indices["componentType"]);
    if (!isUnsigned(sparse.indexType)) {
        indices["componentType"].fail("must be 5121, 5123 or 5125");
    }
    sparse.indexView = indices["bufferView"].index(views_.count(), "/bufferViews");
    sparse.indexOffset = indices["byteOffset"].integerOr(0, kMaxBufferBytes);
    checkFits(sparse.indexOffset, sparse.count, sizeOf(sparse.indexType), sizeOf(sparse.indexType),
              views_.length(sparse.indexView), indices);
    sparse.valueView = values["bufferView"].index(views_.count(), "/bufferViews");
    sparse.valueOffset = values["byteOffset"].integerOr(0, kMaxBufferBytes);
    checkFits(sparse.valueOffset, sparse.count, accessor.elementBytes, accessor.elementBytes,
              views_.length(sparse.valueView), values);
    return sparse;
}

void Accessors::takeUnbacked(uint32_t index) {
    const Accessor& accessor = accessors_[index];
    if (accessor.view) {
        return;
    }
    unbacked_ += uint64_t{accessor.count} * accessor.elementBytes;
    if (unbacked_ > kMaxUnbackedBytes) {
        nodes_[index].fail(fmt::format(
            "with it, {} bytes of zeros are read that no buffer view backs; at most {} are allowed",
            unbacked_, kMaxUnbackedBytes));
    }
}

template <typename Element>
std::vector<Element> Accessors::read(uint32_t index, uint32_t components) {
    const Accessor& accessor = accessors_[index];
    if (accessor.components != components || accessor.matrix) {
        nodes_[index]["type"].fail(components == 1 ? "must be SCALAR here"
                                                   : fmt::format("must be VEC{} here", components));
    }
    takeUnbacked(index);
    std::vector<Element> elements(accessor.count, Element(0.0f));
    readInto(index, reinterpret_cast<float*>(elements.data()));
    return elements;
}

/// Over zeros, count * components of them.
void Accessors::readInto(uint32_t index, float* out) {
    const Accessor& accessor = accessors_[index];
    if (accessor.view && accessor.count > 0) {
        const std::byte* data = views_.bytes(*accessor.view).data() + accessor.offset;
        convert(accessor, data, accessor.stride, accessor.count, out);
    }
    if (accessor.sparse) {
        applySparse(index, out);
    }
}

std::vector<float> Accessors::numbers(uint32_t index) {
    const Accessor& accessor = accessors_[index];
    if (accessor.matrix) {
        nodes_[index]["type"].fail("must be SCALAR or VECn here");
    }
    takeUnbacked(index);
    std::vector<float> result(uint64_t{accessor.count} * accessor.components, 0.0f);
    readInto(index, result.data());
    return result;
}

std::vector<glm::mat4> Accessors::mat4s(uint32_t index) {
    const Accessor& accessor = accessors_[index];
    if (!accessor.matrix || accessor.components != 16 || accessor.type != ComponentType::f32) {
        nodes_[index].fail("must be a MAT4 of component type 5126 here");
    }
    takeUnbacked(index);
    std::vector<glm::mat4> result(accessor.count, glm::mat4(0.0f));
    readInto(index, reinterpret_cast<float*>(result.data()));
    return result;
}

std::vector<uint32_t> Accessors::sparseIndices(uint32_t index) {
    const Accessor::Sparse& sparse = *accessors_[index].sparse;
    const auto bytes = views_.bytes(sparse.indexView);
    std::vector<uint32_t> indices(sparse.count);
    for (uint32_t i = 0; i < sparse.count; ++i) {
        indices[i] = readUnsigned(bytes.data() + sparse.indexOffset + uint64_t{i} * sizeOf(sparse.indexType),
                                  sparse.indexType);
        if (indices[i] >= accessors_[index].count || (i > 0 && indices[i] <= indices[i - 1])) {
            nodes_[index]["sparse"]["indices"].fail(fmt::format(
                "element {} is {}: must grow and be less than {}", i, indices[i], accessors_[index].count));
        }
    }
    return indices;
}

void Accessors::applySparse(uint32_t index, float* out) {
    const Accessor& accessor = accessors_[index];
    const std::vector<uint32_t> indices = sparseIndices(index);
    const std::byte* values = views_.bytes(accessor.sparse->valueView).data() + accessor.sparse->valueOffset;
    for (uint64_t i = 0; i < indices.size(); ++i) {
        convert(accessor, values + i * accessor.elementBytes, accessor.elementBytes, 1,
                out + uint64_t{indices[i]} * accessor.components);
    }
}

std::vector<float> Accessors::scalars(uint32_t index) {
    return read<float>(index, 1);
}
std::vector<glm::vec2> Accessors::vec2s(uint32_t index) {
    return read<glm::vec2>(index, 2);
}
std::vector<glm::vec3> Accessors::vec3s(uint32_t index) {
    return read<glm::vec3>(index, 3);
}
std::vector<glm::vec4> Accessors::vec4s(uint32_t index) {
    return read<glm::vec4>(index, 4);
}

std::vector<glm::vec4> Accessors::vec4s(uint32_t index, float w) {
    if (accessors_[index].components != 3 || accessors_[index].matrix) {
        return vec4s(index);
    }
    const std::vector<glm::vec3> threes = vec3s(index);
    std::vector<glm::vec4> fours(threes.size());
    std::transform(threes.begin(), threes.end(), fours.begin(), [w](glm::vec3 v) { return glm::vec4(v, w); });
    return fours;
}

std::vector<uint32_t> Accessors::integers(uint32_t index) {
    const Accessor& accessor = accessors_[index];
    if (accessor.components != 1 || !isUnsigned(accessor.type) || accessor.normalized) {
        nodes_[index].fail("must be a SCALAR of component type 5121, 5123 or 5125, not normalized");
    }
    takeUnbacked(index);
    std::vector<uint32_t> result(accessor.count, 0);
    if (accessor.view && accessor.count > 0) {
        const std::byte* data = views_.bytes(*accessor.view).data() + accessor.offset;
        for (uint64_t i = 0; i < accessor.count; ++i) {
            result[i] = readUnsigned(data + i * accessor.stride, accessor.type);
        }
    }
    if (accessor.sparse) {
        const std::vector<uint32_t> targets = sparseIndices(index);
        const std::byte* values =
            views_.bytes(accessor.sparse->valueView).data() + accessor.sparse->valueOffset;
        for (uint64_t i = 0; i < targets.size(); ++i) {
            result[targets[i]] = readUnsigned(values + i * accessor.elementBytes, accessor.type);
        }
    }
    return result;
}

}  // namespace tilefarm
