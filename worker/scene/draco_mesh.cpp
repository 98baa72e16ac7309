#include "worker/scene/draco_mesh.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace tilefarm {
namespace {

/// What a normalised integer of this type is divided by; 1 for floats.
double largestOf(draco::DataType type) {
    switch (type) {
        case draco::DT_INT8: return std::numeric_limits<int8_t>::max();
        case draco::DT_UINT8: return std::numeric_limits<uint8_t>::max();
        case draco::DT_INT16: return std::numeric_limits<int16_t>::max();
        case draco::DT_UINT16: return std::numeric_limits<uint16_t>::max();
        case draco::DT_INT32: return std::numeric_limits<int32_t>::max();
        case draco::DT_UINT32: return std::numeric_limits<uint32_t>::max();
        default: return 1;
    }
}

}  // namespace

struct DracoMesh::Impl {
    std::unique_ptr<draco::Mesh> mesh;
};

DracoMesh::DracoMesh(std::span<const std::byte> compressed, const JsonNode& node)
    : impl_(std::make_unique<Impl>()), node_(node) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(compressed.data()), compressed.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) {
        node.fail(fmt::format("its compressed data is malformed ({})", decoded.status().error_msg_string()));
    }
    impl_->mesh = std::move(decoded).value();
}

DracoMesh::~DracoMesh() = default;

uint32_t DracoMesh::vertexCount() const {
    return impl_->mesh->num_points();
}

std::vector<uint32_t> DracoMesh::indices() const {
    std::vector<uint32_t> result;
    result.reserve(size_t{impl_->mesh->num_faces()} * 3);
    for (draco::FaceIndex face(0); face < impl_->mesh->num_faces(); ++face) {
        for (draco::PointIndex corner : impl_->mesh->face(face)) {
            result.push_back(corner.value());
        }
    }
    return result;
}

std::vector<float> DracoMesh::attribute(const std::string& name, uint32_t components, bool normalized) const {
    const JsonNode id = node_["attributes"][name];
    draco::Mesh& mesh = *impl_->mesh;
    const int index = mesh.GetAttributeIdByUniqueId(
        static_cast<uint32_t>(id.integer(std::numeric_limits<uint32_t>::max())));
    if (index < 0 || static_cast<uint32_t>(mesh.attribute(index)->num_components()) != components) {
        id.fail(fmt::format("is not an attribute of {} components in the compressed data", components));
    }
    draco::PointAttribute& attribute = *mesh.attribute(index);
    attribute.set_normalized(false);  // the accessor decides, not the encoder
    const double scale = normalized ? largestOf(attribute.data_type()) : 1;
    std::vector<float> values(size_t{vertexCount()} * components);
    for (draco::PointIndex point(0); point < vertexCount(); ++point) {
        const draco::AttributeValueIndex source = attribute.mapped_index(point);
        float* out = values.data() + size_t{point.value()} * components;
        if (source.value() >= attribute.size() ||
            !attribute.ConvertValue<float>(source, static_cast<int8_t>(components), out)) {
            id.fail(fmt::format("its value for vertex {} cannot be read", point.value()));
        }
        for (uint32_t c = 0; c < components && normalized; ++c) {
            out[c] = static_cast<float>(std::max(out[c] / scale, -1.0));
        }
    }
    return values;
}

}  // namespace tilefarm
