#pragma once

#include <optional>
#include <vector>

#include "worker/scene/load_context.h"
#include "worker/scene/part_list.h"

namespace tilefarm {

/// The shapes that a file declares: KHR_implicit_shapes, and TILEFARM_shapes (docs/vendor-extensions.md) for
/// what the former lacks. The fault of a broken one comes when a node shows it.
class ShapeReader {
public:
    explicit ShapeReader(LoadContext& load);

    /// The shape that a node shows, if it shows one; placed by `toWorld`. Warns of what is rendered
    /// otherwise.
    std::optional<Shape> shapeOf(const JsonNode& node, const glm::dmat4& toWorld) const;

private:
    struct Declared {
        Shape shape;  // its toWorld: from the shape's own space to the node's
        bool endless = false;
    };
    static Declared implicitShape(const JsonNode& node);
    static Declared surface(const JsonNode& node);
    void warnOf(const Shape& shape, bool endless, const JsonNode& node) const;

    LoadContext& load_;
    PartList<Declared> implicit_, surfaces_;
};

}  // namespace tilefarm
