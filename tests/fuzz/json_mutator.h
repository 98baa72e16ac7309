#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tilefarm::fuzz {

// Keeps the order of members; and is no type of the readers under test, so that the mutators can do without
// the instrumentation that those have (CMakeLists.txt).
using Json = nlohmann::ordered_json;

/// Changes JSON documents in structure, as no change of single bytes does: members and elements go, double,
/// move and swap; values change type; numbers become extremes, neighbours and indices of nothing; keys and
/// words become others of the vocabulary. What comes out is JSON again.
class JsonMutator {
public:
    /// `vocabulary`: keys and words that the reader of the documents knows.
    JsonMutator(uint32_t seed, std::span<const std::string_view> vocabulary)
        : random_(seed), vocabulary_(vocabulary) {}

    /// One change somewhere.
    void mutate(Json& document);
    /// Puts a part of `other` into `document`: over a value, as a member of an object, or as an element.
    void cross(Json& document, const Json& other);

    /// 0 … n - 1; n above 0.
    size_t below(size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random_); }
    bool oneIn(size_t n) { return below(n) == 0; }

private:
    // Any value of the document, deep ones as likely as others of their depth.
    Json& somewhere(Json& document);
    Json value();
    Json number();
    std::string word();
    void changeNumber(Json& node);
    void changeString(Json& node);
    void changeObject(Json& node);
    void changeArray(Json& node);

    std::mt19937 random_;
    std::span<const std::string_view> vocabulary_;
};

/// JSON as text, whatever bytes its strings hold.
std::string textOf(const Json& document);

}  // namespace tilefarm::fuzz
