#include "worker/scene/json_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "shared/error/error.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 128;
constexpr size_t kMostWarnings = 200;
constexpr const char* kInvalid = "not valid glTF";

[[noreturn]] void failDocument(const std::string& file, const std::string& fault) {
    throw Error(ErrorCode::invalidArgument, fmt::format("{}: {}", file, fault));
}

/// Watches the parser for nesting and repeated keys, which nlohmann::json itself accepts.
class StructureCheck {
public:
    explicit StructureCheck(JsonSource& source) : source_(source) {}

    bool operator()(int depth, json::parse_event_t event, const json& parsed) {
        if (depth > kMaxDepth) {
            failDocument(source_.file, fmt::format("the JSON is nested deeper than {} levels", kMaxDepth));
        }
        switch (event) {
            case json::parse_event_t::object_start:
            case json::parse_event_t::array_start: open(event == json::parse_event_t::array_start); break;
            case json::parse_event_t::object_end:
            case json::parse_event_t::array_end: levels_.pop_back(); break;
            case json::parse_event_t::key: take(parsed.get_ref<const std::string&>()); break;
            case json::parse_event_t::value: countElement(); break;
        }
        return true;
    }

private:
    struct Level {
        bool array = false, extras = false;  // extras: within what is no part of the scene
        size_t elements = 0;
        std::string step;  // to the value that is read now
        std::unordered_set<std::string> keys;
    };

    void countElement() {
        if (!levels_.empty() && levels_.back().array) {
            levels_.back().step = std::to_string(levels_.back().elements++);
        }
    }

    void open(bool array) {
        countElement();
        Level level;
        level.array = array;
        level.extras = !levels_.empty() && (levels_.back().extras || levels_.back().step == "extras");
        levels_.push_back(std::move(level));
    }

    void take(const std::string& key) {
        Level& level = levels_.back();
        level.step = key;
        if (level.keys.insert(key).second) {
            return;
        }
        const std::string fault = fmt::format("the JSON key \"{}\" stands twice in one object", key);
        if (!level.extras || source_.strict) {
            failDocument(source_.file, fmt::format("{}: {}", place(), fault));
        }
        source_.warn(kInvalid, place().substr(1), fault + "; nothing reads it");
    }

    std::string place() const {
        std::string place;
        for (const Level& level : levels_) {
            place += "/" + pointerToken(level.step);
        }
        return place;
    }

    JsonSource& source_;
    std::vector<Level> levels_;
};

}  // namespace

JsonNode JsonNode::operator[](std::string_view key) const {
    std::string place = place_ + "/" + pointerToken(key);
    if (!value_) {
        return {nullptr, std::move(place), source_};
    }
    if (!value_->is_object()) {
        failType("an object");
    }
    auto found = value_->find(key);
    return {found == value_->end() ? nullptr : &*found, std::move(place), source_};
}

JsonNode JsonNode::operator[](size_t index) const {
    return {&value().at(index), fmt::format("{}/{}", place_, index), source_};
}

bool JsonNode::isString() const {
    return value_ && value_->is_string();
}

bool JsonNode::isObject() const {
    return value_ && value_->is_object();
}

size_t JsonNode::size() const {
    if (!value_) {
        return 0;
    }
    if (!value_->is_array()) {
        failType("an array");
    }
    return value_->size();
}

std::vector<std::string> JsonNode::keys() const {
    std::vector<std::string> keys;
    if (!value_) {
        return keys;
    }
    if (!value_->is_object()) {
        failType("an object");
    }
    for (const auto& [key, member] : value_->items()) {
        keys.push_back(key);
    }
    return keys;
}

const std::string& JsonNode::text() const {
    if (!value().is_string()) {
        failType("a string");
    }
    return value_->get_ref<const std::string&>();
}

std::string JsonNode::textOr(const std::string& fallback) const {
    return value_ ? text() : fallback;
}

double JsonNode::number() const {
    if (!value().is_number()) {
        failType("a number");
    }
    return value_->get<double>();
}

double JsonNode::numberOr(double fallback) const {
    return value_ ? number() : fallback;
}

bool JsonNode::booleanOr(bool fallback) const {
    if (!value_) {
        return fallback;
    }
    if (!value_->is_boolean()) {
        failType("true or false");
    }
    return value_->get<bool>();
}

uint64_t JsonNode::integer(uint64_t max) const {
    if (!value().is_number()) {
        failType("an integer");
    }
    uint64_t result = 0;
    if (value_->is_number_unsigned()) {
        result = value_->get<uint64_t>();
    } else {
        // A double holds integers exactly up to 2^53, beyond which no offset or count of ours goes.
        const double real = value_->get<double>();
        if (!(real >= 0 && real <= 9007199254740992.0) || real != std::floor(real)) {
            fail(fmt::format("must be an integer of 0 … {}, is {}", max, value_->dump()));
        }
        result = static_cast<uint64_t>(real);
    }
    if (result > max) {
        fail(fmt::format("must be an integer of 0 … {}, is {}", max, result));
    }
    return result;
}

uint64_t JsonNode::integerOr(uint64_t fallback, uint64_t max) const {
    return value_ ? integer(max) : fallback;
}

uint32_t JsonNode::index(size_t count, const char* array) const {
    constexpr uint64_t max = 0xfffffffeu;
    const uint64_t result = integer(max);
    if (result >= count) {
        fail(fmt::format("refers to {}/{}, but there are only {}", array, result, count));
    }
    return static_cast<uint32_t>(result);
}

std::vector<double> JsonNode::numbers(size_t count) const {
    value();
    if (size() != count) {
        fail(fmt::format("must have {} numbers, has {}", count, size()));
    }
    std::vector<double> result(count);
    for (size_t i = 0; i < count; ++i) {
        result[i] = (*this)[i].number();
    }
    return result;
}

void JsonNode::fail(const std::string& fault) const {
    const std::string shown = place_.empty() ? "/" : place_;
    throw Error(ErrorCode::invalidArgument, fmt::format("{}: {}: {}", source_->file, shown, fault),
                {{place_, fault}});
}

const json& JsonNode::value() const {
    if (!value_) {
        fail("is missing");
    }
    return *value_;
}

void JsonNode::failType(const char* wanted) const {
    fail(fmt::format("must be {}, is {}", wanted, value_->type_name()));
}

void JsonNode::tolerate(const std::string& fault, const std::string& instead) const {
    if (source_->strict) {
        fail(fault);
    }
    warn(kInvalid, fmt::format("{}; {}", fault, instead));
}

void JsonNode::forgive(const Error& fault) const {
    if (source_->strict) {
        throw fault;
    }
    // Without the file's place on this machine, which is nobody else's affair.
    const bool placed = !fault.faults.empty();
    warn("broken, not used",
         placed ? fault.faults[0].pointer + ": " + fault.faults[0].message : fault.what());
    if (!source_->firstForgiven) {
        source_->firstForgiven = fault;
    }
}

void JsonNode::warn(const std::string& feature, const std::string& instead) const {
    source_->warn(feature, labelOf(*this), instead);
}

std::string labelOf(const JsonNode& node) {
    std::string label = node.place().empty() ? "" : node.place().substr(1);
    if (node && node.isObject()) {
        if (const JsonNode name = node["name"]; name.isString()) {
            label += " (" + name.text() + ")";
        }
    }
    return label;
}

void JsonSource::warn(const std::string& feature, const std::string& where, const std::string& instead) {
    const auto same = [&](const SceneWarning& w) { return w.feature == feature && w.where == where; };
    if (warnings.size() < kMostWarnings && std::none_of(warnings.begin(), warnings.end(), same)) {
        warnings.push_back({feature, where, instead});
        if (warnings.size() == kMostWarnings) warnings.back().instead += "; further faults are not listed";
    }
}

JsonDocument::JsonDocument(std::string_view text, std::string file, bool strict)
    : source_(std::make_unique<JsonSource>(JsonSource{std::move(file), strict})) {
    try {
        json_ = std::make_unique<json>(json::parse(text.begin(), text.end(), StructureCheck(*source_)));
    } catch (const json::exception& fault) {
        failDocument(source_->file, fmt::format("is not valid JSON: {}", fault.what()));
    }
    if (!json_->is_object()) {
        failDocument(source_->file, "the JSON is not an object");
    }
}

JsonDocument::~JsonDocument() = default;

namespace {

// A pointer that was checked may still lead through something that is neither object nor array.
template <typename Value>
void setAt(json& document, const std::string& file, const std::string& pointer, const Value& value) {
    try {
        document[json::json_pointer(pointer)] = value;
    } catch (const json::exception&) {
        const std::string fault = "no value can be put there";
        throw Error(ErrorCode::invalidArgument, fmt::format("{}: {}: {}", file, pointer, fault), {{pointer, fault}});
    }
}

}  // namespace

void JsonDocument::set(const std::string& pointer, const std::vector<double>& numbers) {
    setAt(*json_, source_->file, pointer, numbers);
}

void JsonDocument::set(const std::string& pointer, double number) {
    setAt(*json_, source_->file, pointer, number);
}

void JsonDocument::set(const std::string& pointer, bool flag) {
    setAt(*json_, source_->file, pointer, flag);
}

}  // namespace tilefarm
