#include "tests/support/embree_oracle.h"

#include <atomic>
#include <cstring>
#include <thread>

namespace tilefarm {
namespace {

RTCRay embreeRay(const TestRay& from) {
    RTCRay ray{};
    ray.org_x = from.origin.x, ray.org_y = from.origin.y, ray.org_z = from.origin.z;
    ray.dir_x = from.direction.x, ray.dir_y = from.direction.y, ray.dir_z = from.direction.z;
    ray.tnear = from.tMin;
    ray.tfar = from.tMax;
    ray.mask = ~0u;
    return ray;
}

}  // namespace

EmbreeOracle::EmbreeOracle(std::span<const glm::vec3> corners, bool robust)
    : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    if (robust) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(glm::vec3), corners.size());
    std::memcpy(vertices, corners.data(), corners.size_bytes());
    auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                                   RTC_FORMAT_UINT3, 12, corners.size() / 3));
    for (uint32_t i = 0; i < corners.size(); ++i) indices[i] = i;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
}

EmbreeOracle::~EmbreeOracle() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

OracleHit EmbreeOracle::closest(const TestRay& ray) const {
    RTCRayHit query;
    query.ray = embreeRay(ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(scene_, &query, nullptr);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {query.ray.tfar, query.hit.primID};
}

std::vector<OracleHit> EmbreeOracle::closest(std::span<const TestRay> rays, unsigned threads) const {
    constexpr size_t kChunk = 4096;
    std::vector<OracleHit> hits(rays.size());
    std::atomic<size_t> next{0};
    const auto work = [&] {
        for (size_t first; (first = next.fetch_add(kChunk)) < rays.size();)
            for (size_t i = first; i < std::min(first + kChunk, rays.size()); ++i) hits[i] = closest(rays[i]);
    };
    std::vector<std::jthread> pool;
    for (unsigned i = 1; i < threads; ++i) pool.emplace_back(work);
    work();
    pool.clear();
    return hits;
}

bool EmbreeOracle::any(const TestRay& ray) const {
    RTCRay query = embreeRay(ray);
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded1(scene_, &query, nullptr);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &query);
#endif
    return query.tfar < 0;
}

}  // namespace tilefarm
