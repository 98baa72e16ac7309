#include "worker/scene/animations.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace tilefarm {
namespace {

Interpolation parseInterpolation(const JsonNode& node) {
    const std::string word = node.textOr("LINEAR");
    if (word == "LINEAR") return Interpolation::linear;
    if (word == "STEP") return Interpolation::step;
    if (word == "CUBICSPLINE") return Interpolation::cubic;
    node.fail(fmt::format("is \"{}\", must be LINEAR, STEP or CUBICSPLINE", word));
}

void checkTimes(const std::vector<float>& times, const JsonNode& input) {
    for (size_t i = 0; i < times.size(); ++i) {
        if (std::isfinite(times[i]) && (i == 0 || times[i] > times[i - 1])) {
            continue;
        }
        const std::string fault =
            fmt::format("key {} is at {} s: times must be finite and grow", i, times[i]);
        if (!std::isfinite(times[i]) || times[i] < times[i - 1]) {
            input.fail(fault);
        }
        input.tolerate(fault, "the later of two keys at one time holds from then on");
    }
}

/// The times and values of one sampler; its width is what the counts say.
Keyframes parseSampler(LoadContext& load, const JsonNode& sampler) {
    const JsonNode input = sampler["input"], output = sampler["output"];
    Keyframes keys;
    keys.interpolation = parseInterpolation(sampler["interpolation"]);
    keys.times = load.accessors.scalars(input.index(load.accessors.count(), "/accessors"));
    keys.values = load.accessors.numbers(output.index(load.accessors.count(), "/accessors"));
    if (keys.times.empty()) {
        input.fail("has no keys");
    }
    checkTimes(keys.times, input);
    const auto bad =
        std::find_if(keys.values.begin(), keys.values.end(), [](float v) { return !std::isfinite(v); });
    if (bad != keys.values.end()) {
        output.fail(fmt::format("number {} is not finite", bad - keys.values.begin()));
    }
    const size_t sets = keys.times.size() * (keys.interpolation == Interpolation::cubic ? 3 : 1);
    if (keys.values.empty() || keys.values.size() % sets != 0) {
        output.fail(fmt::format("has {} numbers for {} keys{}", keys.values.size(), keys.times.size(),
                                sets == keys.times.size() ? "" : " with their tangents"));
    }
    keys.width = static_cast<uint32_t>(keys.values.size() / sets);
    return keys;
}

void checkRotations(const Keyframes& keys, const JsonNode& output) {
    const size_t step = keys.interpolation == Interpolation::cubic ? 3 : 1, first = step == 3 ? 1 : 0;
    for (size_t k = 0; k < keys.times.size(); ++k) {
        const float* q = &keys.values[(k * step + first) * 4];
        const double length =
            std::hypot(std::hypot(double{q[0]}, double{q[1]}), std::hypot(double{q[2]}, double{q[3]}));
        if (!(length > 1e-6 && length < 1e6)) {
            output.fail(fmt::format("key {} is not a unit quaternion", k));
        }
    }
}

std::string pointerOf(LoadContext& load, const JsonNode& target) {
    const JsonNode pointer = target["extensions"]["KHR_animation_pointer"]["pointer"];
    if (target["path"].text() == "pointer" || pointer) {
        return pointer.text();
    }
    const JsonNode node = target["node"];
    if (!node) {
        return {};  // glTF has such channels ignored
    }
    return fmt::format("/nodes/{}/{}", node.index(load.file.root()["nodes"].size(), "/nodes"),
                       target["path"].text());
}

/// What a pointer leads to, which must be in the file.
JsonNode follow(JsonNode at, const std::string& pointer, const JsonNode& where) {
    for (size_t begin = 1; begin < pointer.size();) {
        const size_t end = std::min(pointer.find('/', begin), pointer.size());
        const std::string token = pointer.substr(begin, end - begin);
        begin = end + 1;
        size_t index = 0;
        const char* last = token.data() + token.size();
        const auto read = std::from_chars(token.data(), last, index);
        if (read.ec != std::errc{} || read.ptr != last) {
            at = at[token];
        } else if (at && index < at.size()) {
            at = at[index];
        } else {
            at = JsonNode(nullptr, "", nullptr);
        }
        if (!at) {
            where.fail(fmt::format("\"{}\" leads nowhere", pointer));
        }
    }
    return at;
}

/// The part of a pointer that must be in the file already: an element of an array, or a texture in it.
std::string ownerOf(const std::string& pointer) {
    const size_t transform = pointer.find("/extensions/KHR_texture_transform/");
    if (transform != std::string::npos) {
        return pointer.substr(0, transform);
    }
    const size_t names =
        pointer.starts_with("/extensions") ? 4 : 2;  // /extensions/KHR_lights_punctual/lights/0
    size_t end = 0;
    for (size_t i = 0; i < names; ++i) {
        end = pointer.find('/', end + 1);
    }
    return pointer.substr(0, end);
}

size_t morphTargets(const JsonNode& root, const std::string& pointer, const JsonNode& owner,
                    const JsonNode& where) {
    JsonNode mesh = owner;
    if (pointer.starts_with("/nodes")) {
        const JsonNode meshes = root["meshes"], index = owner["mesh"];
        if (!index) {
            where.fail(fmt::format("moves the weights of {}, which has no mesh", owner.place()));
        }
        mesh = meshes[index.index(meshes.size(), "/meshes")];
    }
    const JsonNode primitives = mesh["primitives"];
    return primitives.size() == 0 ? 0 : primitives[0]["targets"].size();
}

double wrapped(double seconds, double length) {
    if (!(length > 0)) {
        return 0;
    }
    const double rest = std::fmod(seconds, length);
    return rest < 0 ? rest + length : rest;
}

}  // namespace

Animations::Animations(LoadContext& load, const std::string& play, bool loop) : loop_(loop) {
    const JsonNode animations = load.file.root()["animations"];
    bool found = play == "all" || play == "none";
    std::string names;
    for (size_t i = 0; i < animations.size(); ++i) {
        const std::string name = animations[i]["name"].textOr(fmt::format("animations/{}", i));
        names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", name);
        found |= name == play;
        if (play == "all" || name == play) {
            read(load, animations[i]);
        } else {
            checkUnplayed(load, animations[i]);
        }
    }
    if (!found) {
        load.file.root()["animations"].fail(
            fmt::format("there is no animation \"{}\"; there is {}", play, names.empty() ? "none" : names));
    }
}

void Animations::read(LoadContext& load, const JsonNode& animation) {
    const JsonNode channels = animation["channels"], samplers = animation["samplers"];
    PartList<Keyframes> keys;
    for (size_t i = 0; i < samplers.size(); ++i) {
        keys.add(samplers[i], [&] { return parseSampler(load, samplers[i]); });
    }
    const size_t before = tracks_.size();
    double length = 0;
    for (size_t i = 0; i < channels.size(); ++i) {
        const uint32_t sampler = channels[i]["sampler"].index(samplers.size(), "samplers");
        const std::string pointer = pointerOf(load, channels[i]["target"]);
        if (pointer.empty()) {
            continue;
        }
        if (!animationTarget(pointer)) {
            load.warn("animation of " + pointer, channels[i], "left at rest");
        } else {
            add(load, channels[i], {pointer, keys[sampler], Kind::number, 0});
        }
    }
    for (size_t i = 0; i < keys.size(); ++i) {
        readIfSound(samplers[i], [&] { length = std::max(length, double{keys[i].times.back()}); });
    }
    for (size_t i = before; i < tracks_.size(); ++i) {
        tracks_[i].length = length;
    }
}

void Animations::checkUnplayed(LoadContext& load, const JsonNode& animation) {
    const size_t before = tracks_.size();
    std::vector<SceneWarning> warnings = load.scene.warnings;
    readIfSound(animation, [&] { read(load, animation); });
    tracks_.resize(before);
    load.scene.warnings = std::move(warnings);  // what does not play is not rendered otherwise
}

void Animations::add(LoadContext& load, const JsonNode& channel, Track track) {
    const AnimationTarget target = *animationTarget(track.pointer);
    const JsonNode root = load.file.root(), where = channel["target"];
    const JsonNode owner = follow(root, ownerOf(track.pointer), where);
    if (track.pointer.starts_with("/nodes") && owner["matrix"] && target.width >= 3) {
        where.fail(fmt::format("moves {}, which has a matrix", owner.place()));
    }
    const size_t width = target.width ? target.width : morphTargets(root, track.pointer, owner, where);
    if (track.keys.width != width) {
        channel["sampler"].fail(fmt::format("its sampler gives {} numbers a key, but {} has {}",
                                            track.keys.width, track.pointer, width));
    }
    track.kind = target.flag ? Kind::flag : target.width == 1 ? Kind::number : Kind::array;
    track.keys.rotation = target.rotation;
    if (track.keys.rotation) {
        checkRotations(track.keys, channel["sampler"]);
    }
    const auto same = [&](const Track& other) { return other.pointer == track.pointer; };
    if (std::any_of(tracks_.begin(), tracks_.end(), same)) {
        load.warn("animations", where,
                  fmt::format("moves {} as another does; the later one holds", track.pointer));
    }
    tracks_.push_back(std::move(track));
}

bool Animations::camerasOnly(const JsonNode& root) const {
    std::vector<bool> joint(root["nodes"].size());
    for (size_t i = 0; i < root["skins"].size(); ++i) {
        const JsonNode skin = root["skins"][i];
        readIfSound(skin, [&] {  // a broken one moves nothing
            for (size_t k = 0; k < skin["joints"].size(); ++k) {
                joint[skin["joints"][k].index(joint.size(), "/nodes")] = true;
            }
        });
    }
    // A node that carries more than a camera carries a mesh, or something by an extension.
    const auto carriesCamerasAlone = [&](uint32_t first) {
        std::vector<uint32_t> open{first};
        std::vector<bool> seen(joint.size());
        while (!open.empty()) {
            const uint32_t index = open.back();
            open.pop_back();
            const JsonNode node = root["nodes"][index];
            if (joint[index] || node["mesh"] || node["extensions"]) {
                return false;
            }
            const JsonNode children = node["children"];
            for (size_t i = 0; i < children.size() && !seen[index]; ++i) {
                open.push_back(children[i].index(joint.size(), "/nodes"));
            }
            seen[index] = true;
        }
        return true;
    };
    return std::all_of(tracks_.begin(), tracks_.end(), [&](const Track& track) {
        constexpr std::string_view nodes = "/nodes/";
        return track.pointer.starts_with("/cameras/") ||
               (track.pointer.starts_with(nodes) &&
                carriesCamerasAlone(static_cast<uint32_t>(std::stoul(track.pointer.substr(nodes.size())))));
    });
}

bool Animations::changeLight() const {
    return std::any_of(tracks_.begin(), tracks_.end(), [](const Track& track) {
        return track.pointer.starts_with("/extensions/KHR_lights_punctual/") ||
               track.pointer.ends_with("/emissiveFactor") || track.pointer.ends_with("/emissiveStrength");
    });
}

double Animations::seconds() const {
    double longest = 0;
    for (const Track& track : tracks_) {
        longest = std::max(longest, track.length);
    }
    return longest;
}

void Animations::apply(JsonDocument& document, double seconds) const {
    for (const Track& track : tracks_) {
        const std::vector<double> values = track.keys.at(loop_ ? wrapped(seconds, track.length) : seconds);
        switch (track.kind) {
            case Kind::number: document.set(track.pointer, values[0]); break;
            case Kind::array: document.set(track.pointer, values); break;
            case Kind::flag: document.set(track.pointer, values[0] >= 0.5); break;
        }
    }
}

}  // namespace tilefarm
