#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <span>
#include <vector>

#include "tests/support/triangle_scenes.h"

namespace tilefarm {

inline constexpr uint32_t kMissed = 0xffffffffu;

struct OracleHit {
    float t = 0;
    uint32_t primitive = kMissed;
};

/// Embree's own traversal with its robust flag.
class EmbreeOracle {
public:
    explicit EmbreeOracle(std::span<const glm::vec3> corners, bool robust = true);
    ~EmbreeOracle();
    EmbreeOracle(const EmbreeOracle&) = delete;
    EmbreeOracle& operator=(const EmbreeOracle&) = delete;

    OracleHit closest(const TestRay& ray) const;
    /// All rays on `threads` threads.
    std::vector<OracleHit> closest(std::span<const TestRay> rays, unsigned threads = 2) const;
    bool any(const TestRay& ray) const;

private:
    RTCDevice device_;
    RTCScene scene_;
};

}  // namespace tilefarm
