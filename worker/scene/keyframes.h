#pragma once

#include <cstdint>
#include <vector>

namespace tilefarm {

enum class Interpolation : uint32_t { linear, step, cubic };

/// A value of `width` numbers over time, as a glTF animation sampler gives it.
struct Keyframes {
    std::vector<float> times;   // s, strictly growing, at least one
    std::vector<float> values;  // width per key; cubic: in-tangent, value and out-tangent of each, 1/s
    uint32_t width = 1;
    Interpolation interpolation = Interpolation::linear;
    bool rotation = false;  // a unit quaternion xyzw: slerp the shorter way, and of unit length at the end

    /// Interpolated in double; before the first key and after the last one their values. glTF 2.0, appendix
    /// C.
    std::vector<double> at(double seconds) const;
};

}  // namespace tilefarm
