// Properties of any set of lights, as points anywhere see them: the probabilities of the light tree, and the
// samples of every light. A case is a scene with one plain light of every kind, which keeps the kernel the
// same, and any others.
#include <algorithm>
#include <cmath>
#define GLM_ENABLE_EXPERIMENTAL
#include <cstring>
#include <glm/gtc/constants.hpp>
#include <glm/gtx/string_cast.hpp>
#include <numbers>
#include <ostream>
#include <random>

#include "tests/property/holds.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/light_probe_runner.h"
#include "tests/shader/light_scenes.h"
#include "tests/support/test_scenes.h"

namespace tilefarm {
namespace {

using std::numbers::pi;

/// Beyond it, a deviation is none of chance: two-sided 5e-9.
constexpr double kLimit = 5.85;

enum class Kind { point, spot, beam, sun, quad, sphere, triangle };
constexpr const char* kNames[]{"point", "spot", "beam", "sun", "quad", "sphere", "triangle"};

struct RandomLight {
    Kind kind = Kind::point;
    float power = 1;  // intensity, irradiance or radiance
    float size = 0.1f;
    float aspect = 1;  // of quads and triangles
    glm::vec3 position{0, 1, 0}, direction{0, -1, 0};
    float inner = 0.2f, outer = 0.5f;  // rad, of spots; of suns the radius
    bool twoSided = false;
};

std::ostream& operator<<(std::ostream& out, const RandomLight& l) {
    return out << "{" << kNames[static_cast<int>(l.kind)] << ", power " << l.power << ", size " << l.size
               << ", aspect " << l.aspect << ", at " << l.position.x << " " << l.position.y << " "
               << l.position.z << ", towards " << l.direction.x << " " << l.direction.y << " "
               << l.direction.z << ", cone " << l.inner << " " << l.outer << (l.twoSided ? ", two sided" : "")
               << "}";
}

/// What lights shine on: a point whose surface faces `normal`, or which has no side.
struct Seen {
    glm::vec3 point{0}, normal{0, 1, 0};
};

std::ostream& operator<<(std::ostream& out, const Seen& s) {
    return out << "{" << s.point.x << " " << s.point.y << " " << s.point.z << ", facing " << s.normal.x << " "
               << s.normal.y << " " << s.normal.z << "}";
}

/// 10^e of an exponent of which a third is 0.
float powerOfTen(int code, int least, int most) {
    if (code < 3000) return 1;
    return std::pow(10.f, static_cast<float>(least) +
                              static_cast<float>(most - least) * static_cast<float>(code - 3000) / 7000);
}

glm::vec3 unitOf(int a, int b) {
    const float z = static_cast<float>(a) / 5000 - 1,
                phi = static_cast<float>(2 * pi) * static_cast<float>(b) / 10000;
    const float r = std::sqrt(std::max(0.f, 1 - z * z));
    return {r * std::cos(phi), z, r * std::sin(phi)};
}

constexpr int kCodes = 14;
rc::Gen<std::vector<int>> codes() {
    return rc::gen::resize(rc::kNominalSize,
                           rc::gen::container<std::vector<int>>(kCodes, rc::gen::inRange(0, 10000)));
}

rc::Gen<RandomLight> anyLight() {
    return rc::gen::map(codes(), [](const std::vector<int>& c) {
        RandomLight l;
        l.kind = static_cast<Kind>(c[0] % 7);
        l.power = c[1] > 9000 ? 0 : powerOfTen(c[1], -30, 30);
        l.size = c[2] > 9500 ? 0 : 0.1f * powerOfTen(c[2], -5, 4);
        l.aspect = powerOfTen(c[3], -4, 0);
        l.position = powerOfTen(c[4], -6, 3) * unitOf(c[5], c[6]);
        l.direction = unitOf(c[7], c[8]);
        static constexpr float cones[]{0.2f, 0, 1e-4f, 1.57079633f, 1};
        l.outer = cones[c[9] % 5];
        l.inner = c[10] % 2 == 0 ? l.outer : l.outer * static_cast<float>(c[10]) / 10000;
        l.twoSided = c[11] % 2 == 1;
        return l;
    });
}

/// Anywhere, in the middle of a light, or just beside one.
rc::Gen<Seen> anyPoint() {
    return rc::gen::map(codes(), [](const std::vector<int>& c) {
        Seen s;
        if (c[0] > 2000) s.point = powerOfTen(c[1], -6, 4) * unitOf(c[2], c[3]);
        if (c[4] > 3000) s.normal = c[4] > 9000 ? glm::vec3(0) : unitOf(c[5], c[6]);
        return s;
    });
}

/// A map that is dark but for a few texels.
struct RandomSky {
    uint32_t width = 16, height = 8;
    float rest = 0, intensity = 1;
    double rotation = 0;
    std::vector<glm::vec3> bright{{9, 2, 3}};  // texel, radiance
};

std::ostream& operator<<(std::ostream& out, const RandomSky& s) {
    out << "{" << s.width << " x " << s.height << ", times " << s.intensity << ", turned by " << s.rotation
        << ", radiance " << s.rest;
    for (const glm::vec3& texel : s.bright) out << ", at " << texel.x << " " << texel.y << ": " << texel.z;
    return out << "}";
}

rc::Gen<RandomSky> anySky() {
    return rc::gen::map(codes(), [](const std::vector<int>& c) {
        RandomSky s;
        s.width = static_cast<uint32_t>(1 + c[0] % 64);
        s.height = static_cast<uint32_t>(1 + c[1] % 32);
        s.rest = c[2] < 5000 ? 0 : powerOfTen(c[2], -10, 2);
        s.intensity = powerOfTen(c[3], -20, 20);
        s.rotation = c[4] < 3000 ? 0 : 2 * pi * c[4] / 10000;
        s.bright.clear();
        for (size_t i = 0; i < static_cast<size_t>(c[5] % 4); ++i)
            s.bright.emplace_back(static_cast<uint32_t>(c[6 + 2 * i]) % s.width,
                                  static_cast<uint32_t>(c[6 + 2 * i] / 64) % s.height,
                                  powerOfTen(c[7 + 2 * i], -6, 10));
        return s;
    });
}

Environment environmentOf(const RandomSky& sky) {
    Environment e = uniformEnvironment(glm::vec3(sky.rest * sky.intensity), sky.width, sky.height);
    for (const glm::vec3& texel : sky.bright) {
        const size_t at = static_cast<size_t>(texel.y) * sky.width + static_cast<size_t>(texel.x);
        for (size_t c = 0; c < 3; ++c) e.image.rgbaFloat[4 * at + c] = texel.z * sky.intensity;
    }
    e.rotation = sky.rotation;
    return e;
}

PunctualLight punctual(const RandomLight& r) {
    if (r.kind == Kind::sun || r.kind == Kind::beam)
        return sunLight(r.direction, r.kind == Kind::sun ? std::max(r.outer, 1e-4f) : 0, r.power);
    PunctualLight lamp;
    lamp.type = r.kind == Kind::spot ? PunctualType::spot : PunctualType::point;
    lamp.position = r.position;
    lamp.direction = r.direction;
    lamp.color = glm::vec3(r.power);
    lamp.innerCone = r.inner;
    lamp.outerCone = r.outer;
    return lamp;
}

void addTo(Scene& scene, const RandomLight& r) {
    const glm::vec3 u = glm::normalize(
        glm::cross(r.direction, std::abs(r.direction.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
    const glm::vec3 v = r.aspect * glm::cross(r.direction, u);
    if (r.kind == Kind::quad) {
        scene.areaLights.push_back(quadLight(r.position, r.size * u, r.size * v, r.power));
        scene.areaLights.back().twoSided = r.twoSided;
    } else if (r.kind == Kind::sphere) {
        scene.areaLights.push_back(sphereLight(r.position, r.size, r.power));
    } else if (r.kind == Kind::triangle) {
        Mesh mesh;
        mesh.positions = {r.position, r.position + r.size * u, r.position + r.size * v};
        mesh.triangles = {{0, 1, 2}};
        addMesh(scene, mesh, matte(glm::vec3(0), glm::vec3(r.power)));
        scene.materials.back().doubleSided = r.twoSided;
    } else {
        scene.lights.push_back(punctual(r));
    }
}

Scene sceneOf(const std::vector<RandomLight>& lights, const RandomSky& sky) {
    Scene scene;
    addMesh(scene, quadMesh({-1, -2, 1}, {2, 0, 0}, {0, 0, -2}), matte(glm::vec3(0.5f)));
    for (int kind = 0; kind < 7; ++kind) {
        RandomLight plain;
        plain.kind = static_cast<Kind>(kind);
        plain.position = {2 * kind - 6, 3, 2};
        addTo(scene, plain);
    }
    for (const RandomLight& light : lights) addTo(scene, light);
    scene.environment = environmentOf(sky);
    return scene;
}

class AnyLights : public DeviceTest {
protected:
    static std::string treeIsADistribution(LightProbe& probe, const std::vector<Seen>& points);
    static std::string samplesAreSound(LightProbe& probe, const std::vector<Seen>& points, int draws);
    static std::string pdfsAgree(LightProbe& probe, const std::vector<RandomLight>& lights,
                                 const std::vector<Seen>& points, int draws);
    static std::string treeFindsWhatMatters(LightProbe& probe, const std::vector<Seen>& points);
    void expectSoundLights(int cases, int lights, int draws);
};

std::string at(const Seen& seen, const std::string& what) {
    std::ostringstream text;
    text << what << " at " << seen << "\n";
    return text.str();
}

/// Draws and probabilities agree: Σ pmf and the share of draws that find no light (where a bound of the tree
/// hid that none can be seen) make 1, and a light drawn has the probability that asking for it gives.
std::string AnyLights::treeIsADistribution(LightProbe& probe, const std::vector<Seen>& points) {
    std::mt19937 random(3);
    constexpr uint32_t kDraws = 256;
    std::vector<LightQuery> queries;
    for (const Seen& seen : points) {
        const glm::vec4 p(seen.point, 0), n(seen.normal, 0);
        for (uint32_t light = 0; light < probe.lightCount(); ++light)
            queries.push_back({p, n, {}, {}, {PROBE_PMF, light, 0, 0}});
        for (uint32_t i = 0; i < kDraws; ++i)
            queries.push_back({p, n, {}, {random(), random(), random(), random()}, {PROBE_TREE, 0, 0, 0}});
    }
    const auto answers = probe.ask(queries);
    std::string faults;
    size_t next = 0;
    for (const Seen& seen : points) {
        double sum = 0;
        bool sound = true;
        for (uint32_t light = 0; light < probe.lightCount(); ++light) {
            const float pmf = answers[next++].chosen.z;
            sound = sound && pmf >= 0 && pmf <= 1;
            sum += double{pmf};
        }
        int none = 0, wrong = 0;
        for (uint32_t i = 0; i < kDraws; ++i) {
            const LightAnswer& a = answers[next++];
            none += a.radiance.w != 1;
            wrong += a.radiance.w == 1 &&
                     (!(a.chosen.y > 0) || !(std::abs(a.chosen.z - a.chosen.y) <= 1e-5f * a.chosen.y));
        }
        if (wrong > 0)
            faults += at(seen, std::to_string(wrong) + " lights drawn with another probability than asked");
        const double dark = 1 - sum, seenDark = double(none) / kDraws;
        const double limit =
            kLimit * std::sqrt(std::max(dark * (1 - dark), 0.0) / kDraws) + kLimit * kLimit / kDraws;
        if (!sound || !(dark >= -1e-5) || !(std::abs(seenDark - dark) <= (dark > 1e-5 ? limit : 1e-5)))
            faults += at(seen, "probabilities sum to " + std::to_string(sum) + ", draws without a light " +
                                   std::to_string(seenDark));
    }
    return faults;
}

/// Finite and not negative; directions of unit length; and the solid angle of a light, the mean of 1 / pdf,
/// no more than that of the sphere, which bounds its irradiance by π times its radiance.
std::string AnyLights::samplesAreSound(LightProbe& probe, const std::vector<Seen>& points, int draws) {
    std::mt19937 random(4);
    std::vector<LightQuery> queries;
    for (const Seen& seen : points)
        for (uint32_t light = 0; light < probe.lightCount(); ++light)
            for (int i = 0; i < draws; ++i)
                queries.push_back({glm::vec4(seen.point, 0),
                                   glm::vec4(seen.normal, 0),
                                   {},
                                   {random(), random(), random(), random()},
                                   {PROBE_SAMPLE, light, static_cast<uint32_t>(i), 0}});
    const auto answers = probe.ask(queries);
    std::string faults;
    size_t next = 0;
    for (const Seen& seen : points)
        for (uint32_t light = 0; light < probe.lightCount(); ++light) {
            double mean = 0, square = 0;
            bool sound = true;
            LightAnswer first{};  // that is not
            for (int i = 0; i < draws; ++i) {
                const LightAnswer& a = answers[next++];
                if (a.radiance.w != 1) continue;
                bool good = std::abs(glm::length(glm::dvec3(a.wi)) - 1) < 1e-5 && a.wi.w >= 0 &&
                            std::isfinite(a.wi.w);
                for (int c = 0; c < 3; ++c) good = good && std::isfinite(a.radiance[c]) && a.radiance[c] >= 0;
                if (sound && !good) first = a;
                sound = sound && good;
                if (!(a.wi.w > 0)) continue;
                const double angle = 1 / double{a.wi.w};
                mean += angle / draws;
                square += angle * angle / draws;
            }
            const double sigma = std::sqrt(std::max(square - mean * mean, 0.0) / draws);
            if (!sound)
                faults += at(seen, "light " + std::to_string(light) +
                                       " gives samples that are not finite or of no direction: " +
                                       glm::to_string(first.wi) + " " + glm::to_string(first.radiance));
            if (!(mean <= 4 * pi * (1 + 1e-4) + 6 * sigma))
                faults +=
                    at(seen, "light " + std::to_string(light) + " covers " + std::to_string(mean) + " sr");
        }
    return faults;
}

/// How far the rounding of coordinates may move a point: a few of the last bits of the largest.
float roundingAt(const glm::vec3& p) {
    return 0x1p-21f * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

/// Whether a point is on a light that from there is as narrow as rounding, which rays towards it may pass by.
bool isOnNeedle(const std::vector<RandomLight>& lights, const glm::vec3& point, const glm::vec3& wi,
                float rounding) {
    return std::any_of(lights.begin(), lights.end(), [&](const RandomLight& l) {
        if (glm::distance(point, l.position) > 1.5f * l.size + 8 * rounding) return false;
        const float tilt = l.kind == Kind::sphere ? 1 : l.aspect * std::abs(glm::dot(wi, l.direction));
        return l.size * tilt < 32 * rounding;
    });
}

/// A sample of a light from a point, and how far rounding may have moved it.
struct Drawn {
    LightQuery query;
    LightAnswer answer;
    glm::vec3 target;
    float rounding;
};

std::vector<Drawn> drawFrom(LightProbe& probe, const std::vector<RandomLight>& lights,
                            const std::vector<Seen>& points, int draws) {
    std::mt19937 random(6);
    std::vector<LightQuery> queries;
    for (const Seen& seen : points)
        for (uint32_t light = 0; light < probe.lightCount(); ++light)
            for (int i = 0; i < draws; ++i)
                queries.push_back({glm::vec4(seen.point, 0),
                                   glm::vec4(0),
                                   {},
                                   {random(), random(), random(), random()},
                                   {PROBE_SAMPLE, light, static_cast<uint32_t>(i), 0}});
    const auto answers = probe.ask(queries);
    std::vector<Drawn> drawn;
    for (size_t i = 0; i < answers.size(); ++i) {
        const LightAnswer& a = answers[i];
        if (a.radiance.w != 1 || !(a.wi.w > 0)) continue;
        const glm::vec3 from(queries[i].position), centre(probe.centre());
        const glm::vec3 target = std::isfinite(a.chosen.x) ? from + a.chosen.x * glm::vec3(a.wi) : from;
        float rounding = std::max(roundingAt(from - centre), roundingAt(target - centre));
        for (const RandomLight& l : lights)
            if (glm::distance(target, l.position) <= 1.5f * l.size + 8 * rounding)
                rounding = std::max(rounding, roundingAt(l.position - centre) + 0x1p-21f * l.size);
        drawn.push_back({queries[i], a, target, rounding});
    }
    return drawn;
}

/// What a ray towards a sample is told of the light there: the pdf that it was drawn with, to 1e-4 and what
/// the pdf changes by where point and direction move within their rounding. A ray that meets nothing of the
/// light has something else in front of it, or passes by its edge within that rounding.
std::string AnyLights::pdfsAgree(LightProbe& probe, const std::vector<RandomLight>& lights,
                                 const std::vector<Seen>& points, int draws) {
    constexpr size_t kMoved = 32;
    const std::vector<Drawn> drawn = drawFrom(probe, lights, points, draws);
    std::vector<LightQuery> queries;
    for (const Drawn& d : drawn) {
        queries.push_back(d.query);
        queries.back().ask.x = PROBE_PDF;
        queries.back().direction = glm::vec4(glm::vec3(d.answer.wi), 0);
    }
    if (queries.empty()) return {};
    const auto asked = probe.ask(queries);

    std::mt19937 random(7);
    std::uniform_real_distribution<float> bits(-1, 1);
    const auto moved = [&](float by) { return by * glm::vec4(bits(random), bits(random), bits(random), 0); };
    std::vector<size_t> doubtful;
    std::vector<LightQuery> again;
    for (size_t i = 0; i < drawn.size(); ++i) {
        const double pdf = double{drawn[i].answer.wi.w}, told = double{asked[i].wi.w};
        // Never chosen: nothing to agree on.
        if (told < 0 || std::abs(told - pdf) <= 1e-4 * pdf) continue;
        doubtful.push_back(i);
        for (size_t k = 0; k < kMoved; ++k) {
            again.push_back(queries[i]);
            again.back().direction += moved(0x1p-22f);
            again.back().position += moved(drawn[i].rounding);
        }
    }
    if (doubtful.empty()) return {};
    const auto around = probe.ask(again);
    std::string faults;
    for (size_t n = 0; n < doubtful.size(); ++n) {
        const Drawn& d = drawn[doubtful[n]];
        const LightAnswer& first = asked[doubtful[n]];
        const double pdf = double{d.answer.wi.w}, told = double{first.wi.w};
        const float reach = d.answer.chosen.x;
        const auto another = [&](const LightAnswer& a) {
            return a.chosen.y == 0 && a.chosen.x < reach + 1e-4f * reach + 8 * d.rounding;
        };
        bool hidden = another(first);
        double changes = 0;
        for (size_t k = n * kMoved; k < (n + 1) * kMoved; ++k) {
            changes = std::max(changes, std::abs(double{around[k].wi.w} - told));
            hidden = hidden || another(around[k]);
        }
        const bool unknown =
            reach < 32 * d.rounding || isOnNeedle(lights, d.target, glm::vec3(d.answer.wi), d.rounding);
        if (unknown || (told == 0 && (hidden || changes > 0))) continue;
        if (std::abs(told - pdf) <= 1e-4 * pdf + 2 * changes) continue;
        std::ostringstream text;
        text << "light " << d.query.ask.y << " drawn towards " << d.answer.wi.x << " " << d.answer.wi.y << " "
             << d.answer.wi.z << " at " << reach << " with pdf " << pdf << ", told " << told << " ± "
             << changes << " at " << first.chosen.x;
        faults += at({glm::vec3(d.query.position), {}}, text.str());
    }
    return faults;
}

/// A light that gives a ten-thousandth of what arrives is never without a chance, where lights differ by less
/// than the 2^32 that a chance can be small.
std::string AnyLights::treeFindsWhatMatters(LightProbe& probe, const std::vector<Seen>& points) {
    if (points.empty()) return {};
    std::mt19937 random(5);
    std::vector<LightQuery> queries;
    for (const Seen& seen : points)
        for (uint32_t light = 0; light < probe.lightCount(); ++light) {
            const glm::vec4 p(seen.point, 0), n(seen.normal, 0);
            queries.push_back({p, n, {}, {}, {PROBE_PMF, light, 0, 0}});
            queries.push_back(
                {p, n, {}, {random(), random(), random(), random()}, {PROBE_SAMPLE, light, 0, 0}});
        }
    const auto answers = probe.ask(queries);
    std::string faults;
    size_t next = 0;
    for (const Seen& seen : points) {
        std::vector<double> gives, pmfs;
        std::vector<glm::vec3> towards;
        double sum = 0;
        for (uint32_t light = 0; light < probe.lightCount(); ++light) {
            pmfs.push_back(double{answers[next++].chosen.z});
            const LightAnswer& a = answers[next++];
            const double cosine =
                seen.normal == glm::vec3(0) ? 1 : double{glm::dot(glm::vec3(a.wi), seen.normal)};
            gives.push_back(a.radiance.w == 1 && cosine > 1e-3
                                ? double{a.radiance.x} * cosine / (a.wi.w > 0 ? double{a.wi.w} : 1)
                                : 0);
            sum += gives.back();
            towards.emplace_back(a.wi);
        }
        for (size_t light = 0; light < gives.size(); ++light)
            if (gives[light] > 1e-4 * sum && !(pmfs[light] > 0))
                faults += at(
                    seen, "light " + std::to_string(light) + " gives " + std::to_string(gives[light] / sum) +
                              " of what arrives and is never chosen, towards " +
                              std::to_string(towards[light].x) + " " + std::to_string(towards[light].y) +
                              " " + std::to_string(towards[light].z));
    }
    return faults;
}

/// Points at some distance from all lights, if none of these outshines the others by far.
std::vector<Seen> moderate(const std::vector<RandomLight>& lights, const RandomSky& sky,
                           std::vector<Seen> points) {
    float most = sky.rest;
    for (const glm::vec3& texel : sky.bright) most = std::max(most, texel.z);
    if (most * sky.intensity > 1e3f) return {};
    for (const RandomLight& l : lights) {
        if (l.power > 1e3f) return {};
        std::erase_if(points,
                      [&](const Seen& s) { return glm::distance(s.point, l.position) < l.size + 0.01f; });
    }
    return points;
}

void AnyLights::expectSoundLights(int cases, int lights, int draws) {
    holds("lights anywhere are sound", cases, [&] {
        const auto sky = *anySky();
        const auto added = *rc::gen::resize(lights, rc::gen::container<std::vector<RandomLight>>(anyLight()));
        auto points = *rc::gen::resize(12, rc::gen::container<std::vector<Seen>>(anyPoint()));
        // In the middle of lights and a little beside them.
        for (const RandomLight& l : added) {
            points.push_back({l.position, l.direction});
            points.push_back({l.position + 1e-6f * l.direction, -l.direction});
            points.push_back({l.position + l.size * l.direction, l.direction});
        }
        points.push_back({});
        RenderSettings settings;
        settings.lightSelection = LightSelection::tree;
        LightProbe probe(device, sceneOf(added, sky), settings);
        require(treeIsADistribution(probe, points));
        require(samplesAreSound(probe, points, draws));
        require(pdfsAgree(probe, added, points, std::max(draws / 8, 1)));
        require(treeFindsWhatMatters(probe, moderate(added, sky, points)));
    });
}

TEST_F(AnyLights, AreSound) {
    expectSoundLights(6, 12, 16);
}
TEST_F(AnyLights, FullAreSound) {
    expectSoundLights(60, 40, 64);
}

}  // namespace
}  // namespace tilefarm
