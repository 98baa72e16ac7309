// Properties of any job, over jobs made from the same table that reads and writes them (fields.h): each
// member is at its default, at an end of its range or anywhere within.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "shared/error/error.h"
#include "shared/job/fields.h"
#include "shared/job/rules.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

// A visitor of `describe` that gives members random values that the table allows. Most stay as they are,
// since many contradict each other.
class RandomMembers {
public:
    explicit RandomMembers(int changeOneIn) : changeOneIn_(changeOneIn) {}

    template <typename T>
    void integer(Member, T& out, IntegerRange r) {
        if (!change()) return;
        const int64_t steps = (r.most - r.least) / r.step;
        const int64_t first = (r.least + r.step - 1) / r.step * r.step;
        const int64_t step = below(4) == 0 ? (below(2) == 0 ? 0 : steps)
                                           : static_cast<int64_t>(share() * static_cast<double>(steps));
        out = static_cast<T>(std::min(r.most / r.step * r.step, first + step * r.step));
    }
    template <typename T>
    void givenInteger(Member m, T& out, IntegerRange r) {
        integer(m, out, r);
    }
    template <std::floating_point T>
    void number(Member, T& out, NumberRange r) {
        if (change()) out = anyNumber<T>(r);
    }
    template <std::floating_point T>
    void triple(Member, std::array<T, 3>& out, NumberRange r) {
        if (!change()) return;
        for (T& value : out) value = anyNumber<T>(r);
    }
    void flag(Member, bool& out) {
        if (change()) out = below(2) == 0;
    }
    void text(Member, std::string& out, TextLength length) {
        if (!change()) return;
        static const std::string_view parts[] = {"a", "Z", "9",  " ",    "\"", "\\",
                                                 "/", "é", "雪", "🙂", "~",  "<"};
        const size_t size = std::min(length.most, length.least + static_cast<size_t>(below(12)));
        out.clear();
        for (size_t i = 0; i < size; ++i) out += parts[static_cast<size_t>(below(std::size(parts)))];
    }
    template <typename Enum, size_t N>
    void choice(Member, Enum& out, const std::array<Choice<Enum>, N>& choices) {
        if (change()) out = choices[static_cast<size_t>(below(N))].value;
    }
    void word(Member, std::string& out, std::span<const std::string_view> words) {
        if (change()) out = words[static_cast<size_t>(below(words.size()))];
    }
    template <typename T>
    void number(Member m, std::optional<T>& out, NumberRange r) {
        if (change()) number(m, out.emplace(static_cast<T>(r.least)), r);
    }
    template <typename T>
    void triple(Member m, std::optional<std::array<T, 3>>& out, NumberRange r) {
        if (!change()) return;
        out.emplace().fill(static_cast<T>(r.least));
        triple(m, *out, r);
    }
    void flag(Member, std::optional<bool>& out) {
        if (change()) out = below(2) == 0;
    }
    template <typename Enum, size_t N>
    void choice(Member, std::optional<Enum>& out, const std::array<Choice<Enum>, N>& choices) {
        if (change()) out = choices[static_cast<size_t>(below(N))].value;
    }
    void word(Member, std::optional<std::string>& out, std::span<const std::string_view> words) {
        if (change()) out = words[static_cast<size_t>(below(words.size()))];
    }
    template <typename T>
    void object(Member, T& out) {
        describe(*this, out);
    }
    // A list of frames is a language of its own, and decides the other members.
    void object(Member, FrameSet& out) {
        static const char* texts[] = {"7", "-3-12", "1-100x10", "1,5,9",
                                      "4-1000000x25,-2147483648,2147483647"};
        if (change()) out = framesFrom(texts[below(std::size(texts))]);
    }
    template <typename T>
    void list(Member, std::vector<T>& out, CountRange count) {
        if (!change()) return;
        out.assign(std::min(count.most, count.least + static_cast<size_t>(below(3))), T{});
        for (T& item : out) {
            RandomMembers members(changeOneIn_);
            describe(members, item);
        }
    }
    void files(Member, std::map<std::string, std::string>& out, CountRange) {
        for (const char* name : {"scene.gltf", "folder/sky.hdr", "folder/a b.png"})
            out[name] = std::string(64, "0123456789abcdef"[static_cast<size_t>(below(16))]);
    }

private:
    bool change() const { return below(static_cast<size_t>(changeOneIn_)) == 0; }
    static int below(size_t n) { return *rc::gen::inRange<int>(0, static_cast<int>(n)); }
    static double share() { return *rc::gen::inRange<int>(0, 1'000'001) / 1e6; }
    template <typename T>
    static T anyNumber(NumberRange r) {
        const double within = r.least + (r.most - r.least) * std::pow(share(), 6);  // often small
        const double values[] = {r.least, r.most, within, within};
        // A float of a double's limit may lie beyond it.
        return static_cast<T>(
            std::clamp(static_cast<double>(static_cast<T>(values[below(4)])), r.least, r.most));
    }
    int changeOneIn_;
};

JobSpec anyJob(int changeOneIn) {
    JobSpec job;
    RandomMembers members(changeOneIn);
    describe(members, job);
    job.scene.entry = "scene.gltf";
    job.scene.environment = *rc::gen::element<std::string>("", "folder/sky.hdr");
    Faults none;
    settleStop(job.stop, none);
    return job;
}

// Of the members that need a value of their own, lists of a random job lack some; those are faults at their
// place.
bool placeIsKnown(const json& job, const std::string& pointer) {
    const json::json_pointer place(pointer);
    return job.contains(place) || job.contains(place.parent_pointer());
}

TEST(AnyJob, SurvivesTheWireOrIsRefusedAtAPlaceOfIt) {
    int accepted = 0, refused = 0;
    const bool held = rc::check("round trip", [&] {
        const JobSpec job = anyJob(*rc::gen::element(3, 10, 30));
        const json written = toJson(job);
        try {
            RC_ASSERT(jobFromJson(written) == job);
            RC_ASSERT(jobFromJson(json::parse(written.dump())) == job);
            ++accepted;
        } catch (const Error& error) {
            RC_ASSERT(error.code == ErrorCode::invalidArgument);
            RC_ASSERT(!error.faults.empty());
            for (const Fault& fault : error.faults) RC_ASSERT(placeIsKnown(written, fault.pointer));
            ++refused;
        }
    });
    EXPECT_TRUE(held);
    // Both ways were taken: neither table nor rules are idle.
    EXPECT_GT(accepted, 10);
    EXPECT_GT(refused, 10);
}

TEST(AnyJob, DamagedInOnePlaceIsRefusedOrStillAJob) {
    const bool held = rc::check("one member replaced", [] {
        const json flat = toJson(anyJob(30)).flatten();
        const auto at = std::next(flat.begin(), *rc::gen::inRange<int>(0, static_cast<int>(flat.size())));
        json damaged = flat;
        damaged[at.key()] = *rc::gen::element<json>(json(), json(-1), json(1e300), json("x"), json(true),
                                                    json(0.5), json(1u << 31), json(std::string(3000, 'y')));
        try {
            const json source = damaged.unflatten();
            const JobSpec job = jobFromJson(source);
            RC_ASSERT(jobFromJson(toJson(job)) == job);
        } catch (const Error& error) {
            RC_ASSERT(error.code == ErrorCode::invalidArgument);
            RC_ASSERT(!error.faults.empty());
        }
    });
    EXPECT_TRUE(held);
}

}  // namespace
}  // namespace tilefarm
