#include "worker/scene/json_node.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 128;

std::string escapePointer(std::string_view key) {
    std::string escaped;
    for (char c : key) {
        if (c == '~') {
            escaped += "~0";
        } else if (c == '/') {
            escaped += "~1";
        } else {
            escaped += c;
        }
    }
    return escaped;
}

[[noreturn]] void failDocument(const std::string& file, const std::string& fault) {
    throw Error(ErrorCode::invalidArgument, fmt::format("{}: {}", file, fault));
}

/// Watches the parser for nesting and repeated keys, which nlohmann::json itself accepts.
class StructureCheck {
public:
    explicit StructureCheck(const std::string& file) : file_(file) {}

    bool operator()(int depth, json::parse_event_t event, const json& parsed) {
        if (depth > kMaxDepth) {
            failDocument(file_, fmt::format("the JSON is nested deeper than {} levels", kMaxDepth));
        }
        if (event == json::parse_event_t::object_start) {
            keys_.emplace_back();
        } else if (event == json::parse_event_t::object_end) {
            keys_.pop_back();
        } else if (event == json::parse_event_t::key) {
            const auto& key = parsed.get_ref<const std::string&>();
            if (!keys_.back().insert(key).second) {
                failDocument(file_, fmt::format("the JSON key \"{}\" stands twice in one object", key));
            }
        }
        return true;
    }

private:
    const std::string& file_;
    std::vector<std::unordered_set<std::string>> keys_;
};

}  // namespace

JsonNode JsonNode::operator[](std::string_view key) const {
    std::string place = place_ + "/" + escapePointer(key);
    if (!value_) {
        return {nullptr, std::move(place), file_};
    }
    if (!value_->is_object()) {
        failType("an object");
    }
    auto found = value_->find(key);
    return {found == value_->end() ? nullptr : &*found, std::move(place), file_};
}

JsonNode JsonNode::operator[](size_t index) const {
    return {&value().at(index), fmt::format("{}/{}", place_, index), file_};
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
    throw Error(ErrorCode::invalidArgument, fmt::format("{}: {}: {}", *file_, shown, fault),
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

JsonDocument::JsonDocument(std::string_view text, std::string file) : file_(std::move(file)) {
    try {
        json_ = std::make_unique<json>(json::parse(text.begin(), text.end(), StructureCheck(file_)));
    } catch (const json::exception& fault) {
        failDocument(file_, fmt::format("is not valid JSON: {}", fault.what()));
    }
    if (!json_->is_object()) {
        failDocument(file_, "the JSON is not an object");
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
    setAt(*json_, file_, pointer, numbers);
}

void JsonDocument::set(const std::string& pointer, double number) {
    setAt(*json_, file_, pointer, number);
}

void JsonDocument::set(const std::string& pointer, bool flag) {
    setAt(*json_, file_, pointer, flag);
}

}  // namespace tilefarm
