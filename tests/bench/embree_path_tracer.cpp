#include "tests/bench/embree_path_tracer.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#if defined(__SSE2__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <thread>

namespace tilefarm::bench {
namespace {

using glm::vec3;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr uint32_t kTile = 32;  // pixels; what a thread takes at a time

/// PCG32 (O'Neill 2014).
class Random {
public:
    Random(uint64_t sequence, uint64_t seed) : increment_((sequence << 1) | 1) {
        next();
        state_ += seed;
        next();
    }
    float uniform() { return float(next() >> 8) * 0x1p-24f; }

private:
    uint32_t next() {
        const uint64_t old = state_;
        state_ = old * 6364136223846793005ull + increment_;
        const uint32_t shifted = uint32_t(((old >> 18) ^ old) >> 27), turn = uint32_t(old >> 59);
        return (shifted >> turn) | (shifted << ((32 - turn) & 31));
    }
    uint64_t state_ = 0, increment_;
};

struct Frame {
    vec3 x, y, z;
    /// Duff et al. 2017: an orthonormal basis around a unit normal.
    explicit Frame(vec3 n) : z(n) {
        const float sign = std::copysign(1.0f, n.z), a = -1.0f / (sign + n.z), b = n.x * n.y * a;
        x = vec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x);
        y = vec3(b, sign + n.y * n.y * a, -n.y);
    }
    vec3 toWorld(vec3 v) const { return v.x * x + v.y * y + v.z * z; }
};

vec3 cosineHemisphere(float u, float v) {
    const float r = std::sqrt(u), phi = glm::two_pi<float>() * v;
    return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0f, 1 - u))};
}

float powerHeuristic(float pdf, float other) {
    return pdf * pdf / (pdf * pdf + other * other);
}

float luminance(vec3 c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

/// Embree's advice for every thread that traces.
void flushDenormals() {
#if defined(__SSE2__)
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
#endif
}

struct Hit {
    float distance = kInfinity;
    uint32_t triangle = kNone;
    vec3 normal{0};  // geometric, unit length, to the outside
};

#if RTC_VERSION_MAJOR >= 4
void intersect1(RTCScene scene, RTCRayHit& ray) {
    rtcIntersect1(scene, &ray);
}
void occluded1(RTCScene scene, RTCRay& ray) {
    rtcOccluded1(scene, &ray);
}
#else
void intersect1(RTCScene scene, RTCRayHit& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &ray);
}
void occluded1(RTCScene scene, RTCRay& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &ray);
}
#endif

/// Triangles of a scene in world space, with what shading needs of them.
struct World {
    std::vector<vec3> corners;           // three per triangle
    std::vector<uint32_t> material;      // per triangle
    std::vector<float> pmf;              // per triangle: chance to be picked as light
    std::vector<uint32_t> lights;        // triangles that emit
    std::vector<float> lightCdf;         // along `lights`
    std::vector<vec3> albedo, emission;  // per material
    float size = 0;

    explicit World(const Scene& scene) {
        for (const Material& m : scene.materials) {
            albedo.push_back(m.baseColor);
            emission.push_back(m.emission);
        }
        for (const Instance& instance : scene.instances) {
            const Mesh& mesh = scene.meshes[instance.mesh];
            for (const glm::uvec3 t : mesh.triangles) {
                for (int k = 0; k < 3; ++k)
                    corners.push_back(vec3(instance.toWorld * glm::dvec4(mesh.positions[t[k]], 1)));
                material.push_back(mesh.material);
            }
        }
        findLights();
        vec3 low(kInfinity), high(-kInfinity);
        for (vec3 p : corners) low = glm::min(low, p), high = glm::max(high, p);
        size = glm::length(high - low);
    }

    float area(uint32_t t) const {
        return 0.5f * glm::length(glm::cross(corners[3 * t + 1] - corners[3 * t],
                                             corners[3 * t + 2] - corners[3 * t]));
    }

private:
    void findLights() {
        pmf.assign(material.size(), 0.0f);
        double total = 0;
        for (uint32_t t = 0; t < material.size(); ++t) {
            const float power = area(t) * luminance(emission[material[t]]);
            if (power <= 0) continue;
            lights.push_back(t);
            pmf[t] = power;
            total += power;
        }
        double sum = 0;
        for (uint32_t t : lights) {
            pmf[t] = float(pmf[t] / total);
            lightCdf.push_back(float(sum += pmf[t]));
        }
    }
};

}  // namespace

struct EmbreePathTracer::Impl {
    World world;
    ImageSpec image;
    RenderSettings settings;
    vec3 origin, right, up, back;  // camera; right and up reach to the image's edges at distance 1
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    double buildSeconds = 0;
    unsigned threads = std::max(1u, std::thread::hardware_concurrency());
    uint32_t samplesDone = 0;
    HostStats stats;
    std::vector<glm::dvec3> sums;

    Impl(const Scene& s, const Camera& camera, const ImageSpec& i, const RenderSettings& r)
        : world(s), image(i), settings(r), sums(size_t{i.width} * i.height) {
        const float tanHalf = std::tan(camera.yfov / 2), aspect = float(i.width) / float(i.height);
        origin = vec3(camera.toWorld[3]);
        right = vec3(glm::normalize(camera.toWorld[0])) * tanHalf * aspect;
        up = vec3(glm::normalize(camera.toWorld[1])) * tanHalf;
        back = vec3(glm::normalize(camera.toWorld[2]));
        build();
    }
    ~Impl() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }

    void build() {
        const auto start = std::chrono::steady_clock::now();
        device = rtcNewDevice(nullptr);
        scene = rtcNewScene(device);
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                 sizeof(vec3), world.corners.size());
        std::memcpy(vertices, world.corners.data(), world.corners.size() * sizeof(vec3));
        auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                                       RTC_FORMAT_UINT3, 3 * sizeof(uint32_t),
                                                                       world.material.size()));
        for (uint32_t k = 0; k < world.corners.size(); ++k) indices[k] = k;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene);
        buildSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    // Steps over the surface it starts on: scenes of the benchmark are all about as large as their box.
    float nearest() const { return 1e-5f * world.size; }

    Hit closestHit(vec3 from, vec3 direction) const {
        RTCRayHit ray{};
        ray.ray.org_x = from.x, ray.ray.org_y = from.y, ray.ray.org_z = from.z;
        ray.ray.dir_x = direction.x, ray.ray.dir_y = direction.y, ray.ray.dir_z = direction.z;
        ray.ray.tnear = nearest(), ray.ray.tfar = kInfinity, ray.ray.mask = ~0u;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        intersect1(scene, ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
        return {ray.ray.tfar, ray.hit.primID, glm::normalize(vec3(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z))};
    }

    bool visible(vec3 from, vec3 direction, float distance) const {
        RTCRay ray{};
        ray.org_x = from.x, ray.org_y = from.y, ray.org_z = from.z;
        ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
        ray.tnear = nearest(), ray.tfar = distance - nearest(), ray.mask = ~0u;
        occluded1(scene, ray);
        return ray.tfar >= 0;
    }

    /// Direct light of one emissive triangle picked by power, weighted against BSDF sampling.
    vec3 sampleLight(vec3 position, vec3 normal, vec3 albedo, Random& random, uint64_t& rays) const {
        const auto found = std::lower_bound(world.lightCdf.begin(), world.lightCdf.end(), random.uniform());
        const size_t pick = std::min<size_t>(size_t(found - world.lightCdf.begin()), world.lights.size() - 1);
        const uint32_t light = world.lights[pick];
        const vec3 a = world.corners[3 * light], b = world.corners[3 * light + 1],
                   c = world.corners[3 * light + 2];
        const float root = std::sqrt(random.uniform()), v = random.uniform();
        const vec3 towards = a * (1 - root) + b * (root * (1 - v)) + c * (root * v) - position;
        const float distance = glm::length(towards);
        const vec3 wi = towards / distance, doubled = glm::cross(b - a, c - a);
        const float cosSurface = glm::dot(normal, wi), area = 0.5f * glm::length(doubled);
        const float cosLight = -glm::dot(doubled, wi) / (2 * area);
        if (cosSurface <= 0 || cosLight <= 0) return vec3(0);
        ++rays;
        if (!visible(position, wi, distance)) return vec3(0);
        const float lightPdf = world.pmf[light] * distance * distance / (cosLight * area);
        const float bsdfPdf = cosSurface * glm::one_over_pi<float>();
        return albedo * world.emission[world.material[light]] *
               (bsdfPdf * powerHeuristic(lightPdf, bsdfPdf) / lightPdf);
    }

    /// Weight of light that a BSDF sample of density `bsdfPdf` found by itself.
    float emissionWeight(const Hit& hit, vec3 direction, float bsdfPdf) const {
        const float cosLight = -glm::dot(hit.normal, direction);
        const float lightPdf =
            world.pmf[hit.triangle] * hit.distance * hit.distance / (cosLight * world.area(hit.triangle));
        return powerHeuristic(bsdfPdf, lightPdf);
    }

    vec3 radiance(vec3 from, vec3 direction, Random& random, uint64_t& rays) const {
        vec3 result(0), throughput(1);
        float bsdfPdf = 0;  // of `direction`; 0 for the camera ray
        for (uint32_t bounce = 0;; ++bounce) {
            ++rays;
            const Hit hit = closestHit(from, direction);
            if (hit.triangle == kNone) return result;
            const uint32_t material = world.material[hit.triangle];
            const bool outside = glm::dot(hit.normal, direction) < 0;
            if (outside && world.pmf[hit.triangle] > 0) {
                const float weight = bounce == 0 ? 1.0f : emissionWeight(hit, direction, bsdfPdf);
                result += throughput * world.emission[material] * weight;
            }
            if (bounce == settings.maxBounces) return result;

            const vec3 normal = outside ? hit.normal : -hit.normal, albedo = world.albedo[material];
            from += direction * hit.distance;
            if (!world.lights.empty()) result += throughput * sampleLight(from, normal, albedo, random, rays);
            const float u = random.uniform(), v = random.uniform();
            const vec3 local = cosineHemisphere(u, v);
            if (local.z <= 0 || luminance(albedo) <= 0) return result;
            direction = Frame(normal).toWorld(local);
            bsdfPdf = local.z * glm::one_over_pi<float>();
            throughput *= albedo;  // f cos / pdf
        }
    }

    uint64_t renderTile(uint32_t tile, uint32_t samples) {
        const uint32_t columns = (image.width + kTile - 1) / kTile;
        const uint32_t x0 = tile % columns * kTile, y0 = tile / columns * kTile;
        uint64_t rays = 0;
        for (uint32_t y = y0; y < std::min(y0 + kTile, image.height); ++y)
            for (uint32_t x = x0; x < std::min(x0 + kTile, image.width); ++x) {
                const uint64_t pixel = uint64_t{y} * image.width + x;
                for (uint32_t s = samplesDone; s < samplesDone + samples; ++s) {
                    Random random(pixel, s);
                    const float px = 2 * (float(x) + random.uniform()) / float(image.width) - 1;
                    const float py = 1 - 2 * (float(y) + random.uniform()) / float(image.height);
                    const vec3 direction = glm::normalize(px * right + py * up - back);
                    sums[pixel] += glm::dvec3(radiance(origin, direction, random, rays));
                }
            }
        return rays;
    }

    void render(uint32_t samples) {
        const uint32_t tiles = ((image.width + kTile - 1) / kTile) * ((image.height + kTile - 1) / kTile);
        std::atomic<uint32_t> next{0};
        std::atomic<uint64_t> rays{0};
        {
            std::vector<std::jthread> pool;
            for (unsigned t = 0; t < threads; ++t)
                pool.emplace_back([&] {
                    flushDenormals();
                    for (uint32_t tile = next++; tile < tiles; tile = next++)
                        rays += renderTile(tile, samples);
                });
        }
        samplesDone += samples;
        stats.samples += uint64_t{samples} * image.width * image.height;
        stats.rays += rays;
    }
};

EmbreePathTracer::EmbreePathTracer(const Scene& scene, const Camera& camera, const ImageSpec& image,
                                   const RenderSettings& settings)
    : impl_(std::make_unique<Impl>(scene, camera, image, settings)) {}
EmbreePathTracer::~EmbreePathTracer() = default;

void EmbreePathTracer::render(uint32_t samples) {
    impl_->render(samples);
}
const HostStats& EmbreePathTracer::stats() const {
    return impl_->stats;
}
double EmbreePathTracer::buildSeconds() const {
    return impl_->buildSeconds;
}
unsigned EmbreePathTracer::threads() const {
    return impl_->threads;
}

double EmbreePathTracer::meanRadiance() const {
    double sum = 0;
    for (const glm::dvec3& pixel : impl_->sums) sum += pixel.x + pixel.y + pixel.z;
    return sum / (3.0 * double(impl_->sums.size()) * std::max(1u, impl_->samplesDone));
}

}  // namespace tilefarm::bench
