#include "worker/scene/keyframes.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

namespace tilefarm {
namespace {

glm::dquat quaternionOf(const std::vector<double>& v) {
    return glm::normalize(glm::dquat(v[3], v[0], v[1], v[2]));
}

std::vector<double> numbersOf(const glm::dquat& q) {
    return {q.x, q.y, q.z, q.w};
}

/// The keys around a time, and where between them it lies.
struct Span {
    size_t from = 0, to = 0;
    double fraction = 0;  // 0 … 1
    double seconds = 0;   // from key to key
};

Span spanAt(const std::vector<float>& times, double seconds) {
    const auto next = std::upper_bound(times.begin(), times.end(), seconds,
                                       [](double t, float key) { return t < double{key}; });
    const auto after = static_cast<size_t>(next - times.begin());
    if (after == 0) {
        return {};
    }
    if (after == times.size()) {
        return {after - 1, after - 1, 0, 0};
    }
    const double begin = times[after - 1], length = times[after] - begin;
    return {after - 1, after, (seconds - begin) / length, length};
}

std::vector<double> blend(const std::vector<double>& a, const std::vector<double>& b, double fraction) {
    std::vector<double> result(a.size());
    for (size_t i = 0; i < a.size(); ++i) {
        result[i] = a[i] * (1 - fraction) + b[i] * fraction;
    }
    return result;
}

/// The Hermite polynomial through both values with the tangents given.
std::vector<double> hermite(const std::vector<double>& a, const std::vector<double>& outTangent,
                            const std::vector<double>& b, const std::vector<double>& inTangent,
                            const Span& span) {
    const double t = span.fraction, t2 = t * t, t3 = t2 * t;
    std::vector<double> result(a.size());
    for (size_t i = 0; i < a.size(); ++i) {
        result[i] = (2 * t3 - 3 * t2 + 1) * a[i] + span.seconds * (t3 - 2 * t2 + t) * outTangent[i] +
                    (3 * t2 - 2 * t3) * b[i] + span.seconds * (t3 - t2) * inTangent[i];
    }
    return result;
}

}  // namespace

std::vector<double> Keyframes::at(double seconds) const {
    const Span span = spanAt(times, seconds);
    const bool cubic = interpolation == Interpolation::cubic;
    const auto part = [&](size_t key, size_t which) {
        const auto first =
            values.begin() + static_cast<std::ptrdiff_t>((cubic ? 3 * key + which : key) * width);
        return std::vector<double>(first, first + width);
    };
    const std::vector<double> a = part(span.from, 1);
    std::vector<double> result = a;
    if (span.from != span.to && interpolation != Interpolation::step) {
        const std::vector<double> b = part(span.to, 1);
        if (cubic) {
            result = hermite(a, part(span.from, 2), b, part(span.to, 0), span);
        } else if (rotation) {
            return numbersOf(glm::slerp(quaternionOf(a), quaternionOf(b), span.fraction));
        } else {
            result = blend(a, b, span.fraction);
        }
    }
    return rotation ? numbersOf(quaternionOf(result)) : result;
}

}  // namespace tilefarm
