#include "worker/scene/transform.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "worker/scene/mesh_repair.h"
#include "worker/scene/mikktspace.h"

namespace tilefarm {

glm::dmat4 composeTransform(glm::dvec3 translation, glm::dvec4 rotation, glm::dvec3 scale) {
    const glm::dquat unit = glm::normalize(glm::dquat(rotation.w, rotation.x, rotation.y, rotation.z));
    return glm::scale(glm::translate(glm::dmat4(1), translation) * glm::mat4_cast(unit), scale);
}

glm::dmat4 localTransform(const JsonNode& node) {
    const JsonNode t = node["translation"], r = node["rotation"], s = node["scale"];
    if (const JsonNode matrix = node["matrix"]) {
        if (t || r || s) {
            node.fail("has both a matrix and a translation, rotation or scale");
        }
        const std::vector<double> v = matrix.numbers(16);
        if (v[3] != 0 || v[7] != 0 || v[11] != 0 || v[15] != 1) {
            matrix.fail("is not an affine transform: its last row must be 0 0 0 1");
        }
        glm::dmat4 result;
        for (int i = 0; i < 16; ++i) {
            result[i / 4][i % 4] = v[size_t(i)];
        }
        return result;
    }
    glm::dvec3 translation(0), scale(1);
    glm::dvec4 rotation(0, 0, 0, 1);
    if (t) {
        const std::vector<double> v = t.numbers(3);
        translation = {v[0], v[1], v[2]};
    }
    if (s) {
        const std::vector<double> v = s.numbers(3);
        scale = {v[0], v[1], v[2]};
    }
    if (r) {
        const std::vector<double> v = r.numbers(4);
        rotation = {v[0], v[1], v[2], v[3]};
        const double length = glm::length(rotation);
        if (!(length > 1e-6 && length < 1e6)) {
            r.fail("is not a unit quaternion");
        }
    }
    return composeTransform(translation, rotation, scale);
}

glm::dmat4 withoutScale(const glm::dmat4& transform) {
    glm::dvec3 z = normalizeOrZero(glm::dvec3(transform[2]));
    if (z == glm::dvec3(0)) {
        z = {0, 0, 1};
    }
    const glm::dvec3 up(transform[1]);
    glm::dvec3 y = normalizeOrZero(normalizeOrZero(up) - z * glm::dot(z, normalizeOrZero(up)));
    if (y == glm::dvec3(0)) {
        y = anyOrthogonal(z);
    }
    glm::dmat4 result(1);
    result[0] = glm::dvec4(glm::cross(y, z), 0);
    result[1] = glm::dvec4(y, 0);
    result[2] = glm::dvec4(z, 0);
    result[3] = transform[3];
    return result;
}

}  // namespace tilefarm
