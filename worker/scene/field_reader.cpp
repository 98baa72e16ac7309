#include "worker/scene/field_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

namespace tilefarm {
namespace {

constexpr double kLargestLength = 1e9;  // m

struct Place {
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
};

glm::dvec3 vectorOr(const JsonNode& node, const glm::dvec3& fallback) {
    if (!node) return fallback;
    const std::vector<double> v = node.numbers(3);
    return {v[0], v[1], v[2]};
}

Place placeOf(const JsonNode& expression, const Place& parent) {
    Place own;
    own.translation = vectorOr(expression["translation"], glm::dvec3(0));
    if (const JsonNode node = expression["rotation"]) {
        const std::vector<double> q = node.numbers(4);
        own.rotation = glm::dquat(q[3], q[0], q[1], q[2]);
        if (!(glm::length(own.rotation) > 1e-6)) node.fail("is not a unit quaternion");
        own.rotation = glm::normalize(own.rotation);
    }
    return {parent.translation + parent.rotation * own.translation, parent.rotation * own.rotation};
}

double within(const JsonNode& node, double fallback, double low, double high) {
    const double value = node.numberOr(fallback);
    if (!(value >= low && value <= high)) node.fail(fmt::format("must be {} … {}", low, high));
    return value;
}

class Compiler {
public:
    std::vector<FieldInstruction> run(const JsonNode& expression) {
        add(expression, Place{}, 1);
        return std::move(field_);
    }

private:
    void add(const JsonNode& expression, const Place& parent, uint32_t depth) {
        if (!expression.isObject()) expression.fail("must be an object");
        if (depth > kMaxFieldStack)
            expression.fail(fmt::format("has more than {} operands waiting at once", kMaxFieldStack));
        const Place place = placeOf(expression, parent);
        const bool group = addGroup(expression, "union", FieldOperation::unite, place, depth) ||
                           addGroup(expression, "intersection", FieldOperation::intersect, place, depth) ||
                           addGroup(expression, "difference", FieldOperation::subtract, place, depth);
        if (!group) addPrimitive(expression, place);
    }

    bool addGroup(const JsonNode& expression, const char* name, FieldOperation operation, const Place& place,
                  uint32_t depth) {
        const JsonNode parts = expression[name];
        if (!parts) return false;
        if (parts.size() == 0) parts.fail("must not be empty");
        const double smooth = within(expression["smooth"], 0, 0, kLargestLength);
        for (size_t i = 0; i < parts.size(); ++i) {
            add(parts[i], place, depth + (i > 0 ? 1 : 0));
            if (i > 0) push({operation, {smooth, 0, 0, 0}, glm::dvec3(0), {0, 0, 0, 1}}, parts[i]);
        }
        return true;
    }

    void addPrimitive(const JsonNode& expression, const Place& place) {
        FieldInstruction primitive;
        primitive.translation = place.translation;
        const glm::dquat& q = place.rotation;
        primitive.rotation = {q.x, q.y, q.z, q.w};
        if (const JsonNode node = expression["sphere"]) {
            primitive.parameters = {positiveOr(node["radius"], 0.5), 0, 0, 0};
        } else if (const JsonNode box = expression["box"]) {
            readBox(box, primitive);
        } else if (const JsonNode torus = expression["torus"]) {
            primitive.operation = FieldOperation::torus;
            primitive.parameters = {positiveOr(torus["radius"], 0.5), positiveOr(torus["tube"], 0.125), 0, 0};
        } else if (const JsonNode cone = expression["cone"]) {
            readCone(cone, primitive);
        } else if (const JsonNode bulb = expression["mandelbulb"]) {
            primitive.operation = FieldOperation::mandelbulb;
            primitive.parameters = {within(bulb["power"], 8, 2, 16),
                                    double(bulb["iterations"].integerOr(8, 32)), 0, 0};
        } else {
            expression.fail(
                "must have one of sphere, box, torus, cone, mandelbulb, union, intersection, difference");
        }
        push(primitive, expression);
    }

    static void readBox(const JsonNode& node, FieldInstruction& primitive) {
        const glm::dvec3 size = vectorOr(node["size"], glm::dvec3(1));
        const double least = std::min({size.x, size.y, size.z});
        if (!(least > 0) || std::max({size.x, size.y, size.z}) > kLargestLength)
            node.fail("has a side that is not above 0");
        primitive.operation = FieldOperation::box;
        primitive.parameters = glm::dvec4(0.5 * size, within(node["rounding"], 0, 0, least / 2));
    }

    static void readCone(const JsonNode& node, FieldInstruction& primitive) {
        primitive.operation = FieldOperation::cone;
        primitive.parameters = {positiveOr(node["height"], 1) / 2,
                                within(node["radiusBottom"], 0.5, 0, kLargestLength),
                                within(node["radiusTop"], 0, 0, kLargestLength), 0};
        if (!(primitive.parameters.y + primitive.parameters.z > 0)) node.fail("has no radius above 0");
    }

    void push(const FieldInstruction& instruction, const JsonNode& where) {
        if (field_.size() == kMaxFieldInstructions)
            where.fail(fmt::format("the field has more than {} operations", kMaxFieldInstructions));
        field_.push_back(instruction);
    }

    std::vector<FieldInstruction> field_;
};

}  // namespace

double positiveOr(const JsonNode& node, double fallback) {
    const double value = node.numberOr(fallback);
    if (!(value > 0 && value <= kLargestLength)) node.fail(fmt::format("must be above 0 and at most {}", kLargestLength));
    return value;
}

std::vector<FieldInstruction> readField(const JsonNode& expression) {
    return Compiler().run(expression);
}

}  // namespace tilefarm
