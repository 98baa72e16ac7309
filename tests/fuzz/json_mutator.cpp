#include "tests/fuzz/json_mutator.h"

#include <algorithm>
#include <array>
#include <limits>

namespace tilefarm::fuzz {
namespace {

constexpr size_t kMostElements = 4096;

// Where readers of counts, offsets, indices and lengths go wrong.
constexpr std::array kNumbers{
    0.0,
    1.0,
    -1.0,
    2.0,
    3.0,
    4.0,
    7.0,
    8.0,
    12.0,
    16.0,
    64.0,
    127.0,
    128.0,
    255.0,
    256.0,
    1000.0,
    4096.0,
    65534.0,
    65535.0,
    65536.0,
    16777216.0,
    16777217.0,
    268435456.0,
    2147483647.0,
    2147483648.0,
    4294967294.0,
    4294967295.0,
    4294967296.0,
    17179869184.0,
    9007199254740992.0,
    18446744073709551615.0,
    0.5,
    -0.5,
    1.5,
    0.1,
    1e-3,
    1e-6,
    1e-9,
    1e-20,
    1.1754943508222875e-38,
    1e-45,
    5e-324,
    1e9,
    1e18,
    1e30,
    3.4028234663852886e38,
    3.5e38,
    1e300,
    1.7976931348623157e308,
    -0.0,
    -2147483648.0,
    -1e30,
    -1e300,
    3.141592653589793,
    6.283185307179586,
    // what glTF calls types, filters and modes
    5120.0,
    5121.0,
    5122.0,
    5123.0,
    5125.0,
    5126.0,
    9728.0,
    9729.0,
    33071.0,
    33648.0,
    34962.0,
};

void collect(Json& node, std::vector<Json*>& all) {
    all.push_back(&node);
    if (node.is_structured())
        for (Json& child : node) collect(child, all);
}

}  // namespace

std::string textOf(const Json& document) {
    return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json& JsonMutator::somewhere(Json& document) {
    std::vector<Json*> all;
    // Half of the time step by step from the root, so that a long array does not take all chances.
    if (oneIn(2)) {
        collect(document, all);
        return *all[below(all.size())];
    }
    Json* node = &document;
    while (node->is_structured() && !node->empty() && !oneIn(6)) {
        auto at = node->begin();
        std::advance(at, static_cast<std::ptrdiff_t>(below(node->size())));
        node = &*at;
    }
    return *node;
}

std::string JsonMutator::word() {
    return vocabulary_.empty() || oneIn(16) ? std::string(below(4), 'a')
                                            : std::string(vocabulary_[below(vocabulary_.size())]);
}

Json JsonMutator::number() {
    if (oneIn(3)) return below(12);  // an index or a count, at times of nothing
    const double given = kNumbers[below(kNumbers.size())];
    // Whole ones mostly as integers: readers tell them apart.
    const bool whole =
        given >= 0 && given < 1.8e19 && given == static_cast<double>(static_cast<uint64_t>(given));
    if (whole && !oneIn(4)) return static_cast<uint64_t>(given);
    return given;
}

Json JsonMutator::value() {
    switch (below(9)) {
        case 0: return nullptr;
        case 1: return oneIn(2);
        case 2: return word();
        case 3: return Json::array();
        case 4: return Json::object();
        case 5: {
            Json numbers = Json::array();
            for (size_t i = 0, n = 1 + below(4) + below(2) * below(16); i < n; ++i)
                numbers.push_back(number());
            return numbers;
        }
        default: return number();
    }
}

void JsonMutator::changeNumber(Json& node) {
    const double old = node.get<double>();
    switch (below(8)) {
        case 0: node = old + 1; break;
        case 1: node = old - 1; break;
        case 2: node = old * 2; break;
        case 3: node = -old; break;
        case 4: node = old / 3; break;
        default: node = number(); return;
    }
    const double changed = node.get<double>();
    if (changed >= 0 && changed < 1e15 && changed == static_cast<double>(static_cast<uint64_t>(changed)))
        node = static_cast<uint64_t>(changed);
}

void JsonMutator::changeString(Json& node) {
    auto text = node.get<std::string>();
    switch (below(6)) {
        case 0: text.resize(below(text.size() + 1)); break;
        case 1:
            if (!text.empty()) text[below(text.size())] = static_cast<char>(below(256));
            break;
        case 2: text += word(); break;
        case 3: text.insert(below(text.size() + 1), 1 + below(3), "/%~\\.*0:"[below(8)]); break;
        default: text = word();
    }
    node = text;
}

void JsonMutator::changeObject(Json& node) {
    if (node.empty() || oneIn(3)) {
        node[word()] = value();
        return;
    }
    auto at = node.begin();
    std::advance(at, static_cast<std::ptrdiff_t>(below(node.size())));
    if (oneIn(3)) {  // renamed
        Json moved = std::move(*at);
        node.erase(at);
        node[word()] = std::move(moved);
    } else if (oneIn(2)) {
        node[word()] = Json(*at);
    } else {
        node.erase(at);
    }
}

void JsonMutator::changeArray(Json& node) {
    if (node.empty() || oneIn(4)) {
        node.push_back(value());
        return;
    }
    const size_t at = below(node.size());
    const auto place = node.begin() + static_cast<std::ptrdiff_t>(at);
    switch (below(5)) {
        case 0: node.erase(place); break;
        case 1: std::swap(node[at], node[below(node.size())]); break;
        case 2: {  // several of the same
            const Json copy = *place;
            const size_t times = oneIn(8) ? 1 + below(200) : 1 + below(3);
            for (size_t i = 0; i < times && node.size() < kMostElements; ++i) node.push_back(copy);
            break;
        }
        case 3: node.insert(place, Json(node[below(node.size())])); break;
        default: node.erase(place, node.end());
    }
}

void JsonMutator::mutate(Json& document) {
    Json& node = somewhere(document);
    const bool root = &node == &document;  // stays what it is: readers refuse anything else at once
    if (!root && oneIn(8)) {
        Json copy = somewhere(document);  // of the document itself, so that no part holds its own
        node = std::move(copy);
        return;
    }
    if (node.is_null() || (!root && oneIn(10))) {
        node = value();
        return;
    }
    if (node.is_number()) return changeNumber(node);
    if (node.is_string()) return changeString(node);
    if (node.is_object()) return changeObject(node);
    if (node.is_array()) return changeArray(node);
    node = !node.get<bool>();
}

void JsonMutator::cross(Json& document, const Json& other) {
    Json copy = other;
    Json part = somewhere(copy);
    Json& node = somewhere(document);
    if (node.is_array() && !oneIn(4) && node.size() < kMostElements) {
        node.push_back(std::move(part));
    } else if (node.is_object() && part.is_object() && !oneIn(4)) {
        for (auto& [key, member] : part.items()) node[key] = member;
    } else {
        node = std::move(part);
    }
}

}  // namespace tilefarm::fuzz
