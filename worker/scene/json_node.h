#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/error/error.h"
#include "worker/scene/scene_warning.h"

namespace tilefarm {

/// What the nodes of a document share.
struct JsonSource {
    std::string file;
    bool strict = false;  // what is tolerated otherwise is a fault
    std::vector<SceneWarning> warnings = {};
    std::optional<Error> firstForgiven = {};

    /// Notes what is read otherwise, once for each feature and place, as far as anybody would read on.
    void warn(const std::string& feature, const std::string& where, const std::string& instead);
};

/// A value in a JSON document together with its place, so that every fault found in it names the file
/// and an RFC 6901 pointer. A member that is not there is a node too, which is false. The document
/// must outlive its nodes. Every reading function throws Error(invalidArgument) on a wrong type.
class JsonNode {
public:
    JsonNode(const nlohmann::json* value, std::string place, JsonSource* source)
        : value_(value), place_(std::move(place)), source_(source) {}

    explicit operator bool() const { return value_ != nullptr; }
    /// A member of an object; false where either is missing.
    JsonNode operator[](std::string_view key) const;
    /// An element of an array; must be less than size().
    JsonNode operator[](size_t index) const;

    bool isString() const;
    bool isObject() const;
    /// Elements of the array, 0 where it is missing.
    size_t size() const;
    /// Keys of the object in alphabetical order, none where it is missing.
    std::vector<std::string> keys() const;

    const std::string& text() const;
    std::string textOr(const std::string& fallback) const;
    double number() const;
    double numberOr(double fallback) const;
    bool booleanOr(bool fallback) const;
    /// An integer of 0 … max; 3.0 counts as one, as in JSON Schema.
    uint64_t integer(uint64_t max) const;
    uint64_t integerOr(uint64_t fallback, uint64_t max) const;
    /// An index into an array of `count` elements, named `array` in the error.
    uint32_t index(size_t count, const char* array) const;
    /// Exactly `count` numbers.
    std::vector<double> numbers(size_t count) const;

    [[noreturn]] void fail(const std::string& fault) const;
    /// Of what the specification forbids and every other reader takes: a warning that says how it is read,
    /// in a strict document a fault.
    void tolerate(const std::string& fault, const std::string& instead) const;
    void warn(const std::string& feature, const std::string& instead) const;
    /// Of a fault in what nothing may need: a warning at this node, in a strict document the fault.
    void forgive(const Error& fault) const;
    /// "/meshes/0/primitives/1"
    const std::string& place() const { return place_; }
    const std::string& fileName() const { return source_->file; }
    /// What it stands for; an error where it is missing.
    const nlohmann::json& json() const { return value(); }

private:
    const nlohmann::json& value() const;
    [[noreturn]] void failType(const char* wanted) const;

    const nlohmann::json* value_;
    std::string place_;
    JsonSource* source_;
};

/// "materials/3 (Cloth)", for people.
std::string labelOf(const JsonNode& node);

/// Owns a parsed document. Refuses what two readers could understand differently (repeated keys, but in
/// extras, which nobody reads, unless it is strict) and nesting deep enough to be an attack. Throws
/// Error(invalidArgument) that names `file`.
class JsonDocument {
public:
    JsonDocument(std::string_view text, std::string file, bool strict = false);
    ~JsonDocument();
    JsonNode root() const { return {json_.get(), "", source_.get()}; }
    const std::string& file() const { return source_->file; }
    /// So far, in the order they were met.
    const std::vector<SceneWarning>& warnings() const { return source_->warnings; }
    /// The first fault that is a warning, as nothing may need what it broke.
    const std::optional<Error>& firstForgiven() const { return source_->firstForgiven; }

    /// Gives the value at an RFC 6901 pointer another one, as an animation does. Objects on the way are made;
    /// nodes of other values stay good. Throws Error(invalidArgument) if it leads through what can hold nothing.
    void set(const std::string& pointer, double number);
    void set(const std::string& pointer, const std::vector<double>& numbers);
    void set(const std::string& pointer, bool flag);

private:
    std::unique_ptr<JsonSource> source_;
    std::unique_ptr<nlohmann::json> json_;
};

}  // namespace tilefarm
