#pragma once

#include <string>
#include <vector>

#include "worker/scene/keyframes.h"
#include "worker/scene/load_context.h"

namespace tilefarm {

/// The animations of a glTF file. Playing writes the values of a moment into the document, where the rest of
/// the loader reads them as if they stood in the file: so node channels and KHR_animation_pointer are one
/// thing, and whatever the loader reads can move.
class Animations {
public:
    /// `play`: "all", "none" or the name of one. What moves two ways at once takes the later animation's. A
    /// sampler or channel that makes no sense throws Error(invalidArgument) with its place; in an animation
    /// that is not played it is a warning, as a property that is not rendered is.
    Animations(LoadContext& load, const std::string& play, bool loop);

    /// Whether anything moves.
    bool empty() const { return tracks_.empty(); }
    /// Whether all that moves are cameras.
    bool camerasOnly(const JsonNode& root) const;
    /// Whether what some lamp or surface emits changes.
    bool changeLight() const;
    /// Of the longest animation played: from time 0 to its last key.
    double seconds() const;
    /// At `seconds`, or at that modulo each animation's length where it loops.
    void apply(JsonDocument& document, double seconds) const;

private:
    enum class Kind { number, array, flag };
    struct Track {
        std::string pointer;  // what it writes
        Keyframes keys;
        Kind kind = Kind::number;
        double length = 0;  // of its animation, s
    };
    void read(LoadContext& load, const JsonNode& animation);
    void checkUnplayed(LoadContext& load, const JsonNode& animation);
    void add(LoadContext& load, const JsonNode& channel, Track track);

    std::vector<Track> tracks_;
    bool loop_;
};

/// What an animation may move: numbers of a property of the document.
struct AnimationTarget {
    uint32_t width = 0;  // 0: as many as the mesh has morph targets
    bool rotation = false;
    bool flag = false;
};

/// The property that an RFC 6901 pointer names, or nothing if it is none that this renderer reads and can
/// move.
std::optional<AnimationTarget> animationTarget(const std::string& pointer);

}  // namespace tilefarm
