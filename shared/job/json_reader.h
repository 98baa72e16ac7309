#pragma once

// Declarative reading and writing of JSON objects. A type says what it has once,
//
//     template <typename Visitor>
//     void describe(Visitor& v, Is<ImageSpec> auto& image) {
//         v.integer({"width", "pixels"}, image.width, {1, 32768});
//     }
//
// and three visitors go over that: JsonReader (strict input with every fault), JsonWriter (canonical
// output) and JsonSchema (JSON Schema 2020-12, for the API description). A new member is one line.
// Includes all of nlohmann's JSON: for .cpp files only.

#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/error/error.h"

namespace tilefarm {

template <typename T, typename Plain>
concept Is = std::same_as<std::remove_const_t<T>, Plain>;

struct Member {
    std::string_view name;
    std::string_view meaning;  // unit and meaning, for people
    bool required = false;     // else it may be left out and keeps its default
};
inline constexpr bool kRequired = true;

struct IntegerRange {
    int64_t least, most;
    int64_t step = 1;  // the value is a multiple of it
};
inline constexpr IntegerRange kAnyUint32{0, std::numeric_limits<uint32_t>::max()};
inline constexpr IntegerRange kAnyInt32{std::numeric_limits<int32_t>::min(),
                                        std::numeric_limits<int32_t>::max()};

struct NumberRange {
    double least, most;
};

struct TextLength {
    size_t least, most;  // characters (code points); control characters are never allowed
};

struct CountRange {
    size_t least, most;
};

template <typename Enum>
struct Choice {
    std::string_view word;
    Enum value;
};

/// A list of faults that ends at 100, so that an answer to a hostile input stays small.
class Faults {
public:
    void add(std::string pointer, std::string message);
    /// Those of an input that stands at `pointer` of this one.
    void addBelow(const std::string& pointer, const Error& error);
    bool none() const { return faults_.empty(); }
    /// True if a fault stands at this place or below it: what depends on it is not worth a word.
    bool at(std::string_view pointer) const;
    /// Throws Error(code) with all faults, if there are any. `what` names the input: "the job".
    void throwIfAny(ErrorCode code, std::string_view what) const;

private:
    std::vector<Fault> faults_;
    bool cut_ = false;
};

/// Reads the members of one JSON object; adds a fault for each that is missing, of the wrong type,
/// out of range or unknown, and leaves the value at its default then.
class JsonReader {
public:
    enum class Unknown { fault, ignore };
    using Json = nlohmann::json;

    JsonReader(const Json& object, std::string pointer, Faults& faults, Unknown unknown = Unknown::fault);

    template <std::integral T>
    requires(!std::same_as<T, bool>) void integer(Member m, T& out, IntegerRange range) {
        if (const Json* value = member(m)) readInteger(*value, place(m), out, range);
    }
    template <std::floating_point T>
    void number(Member m, T& out, NumberRange range) {
        double read = 0;
        if (const Json* value = member(m); value && readNumber(*value, place(m), read, range))
            out = static_cast<T>(read);
    }
    /// Three numbers: a colour, a place, a direction.
    template <std::floating_point T>
    void triple(Member m, std::array<T, 3>& out, NumberRange range) {
        const Json* value = member(m);
        if (!value || !isListOf(*value, place(m), {3, 3})) return;
        for (size_t i = 0; i < 3; ++i) {
            double read = 0;
            if (readNumber((*value)[i], place(m) + "/" + std::to_string(i), read, range))
                out[i] = static_cast<T>(read);
        }
    }
    void flag(Member m, bool& out);
    void text(Member m, std::string& out, TextLength length);
    void texts(Member m, std::vector<std::string>& out, CountRange count, TextLength each);
    template <typename Enum, size_t N>
    void choice(Member m, Enum& out, const std::array<Choice<Enum>, N>& choices) {
        std::array<std::string_view, N> words;
        for (size_t i = 0; i < N; ++i) words[i] = choices[i].word;
        const Json* value = member(m);
        size_t index = 0;
        if (value && readWord(*value, place(m), words, index)) out = choices[index].value;
    }
    void word(Member m, std::string& out, std::span<const std::string_view> words);

    // Members without a default, which may be left out.
    /// 0 stands for one that is not given, and cannot be given.
    template <std::integral T>
    void givenInteger(Member m, T& out, IntegerRange range) {
        integer(m, out, range);
    }
    template <typename T>
    void number(Member m, std::optional<T>& out, NumberRange range) {
        ifGiven(m, out, [&](T& value) { number(m, value, range); });
    }
    template <typename T>
    void triple(Member m, std::optional<std::array<T, 3>>& out, NumberRange range) {
        ifGiven(m, out, [&](std::array<T, 3>& value) { triple(m, value, range); });
    }
    void flag(Member m, std::optional<bool>& out) {
        ifGiven(m, out, [&](bool& value) { flag(m, value); });
    }
    template <typename Enum, size_t N>
    void choice(Member m, std::optional<Enum>& out, const std::array<Choice<Enum>, N>& choices) {
        ifGiven(m, out, [&](Enum& value) { choice(m, value, choices); });
    }
    void word(Member m, std::optional<std::string>& out, std::span<const std::string_view> words) {
        ifGiven(m, out, [&](std::string& value) { word(m, value, words); });
    }
    template <typename T>
    void object(Member m, T& out) {
        if (const Json* value = member(m)) read(*value, place(m), *faults_, out, unknown_);
    }
    template <typename T>
    void list(Member m, std::vector<T>& out, CountRange count) {
        const Json* value = member(m);
        if (!value || !isListOf(*value, place(m), count)) return;
        out.assign(value->size(), T{});
        for (size_t i = 0; i < out.size(); ++i)
            read((*value)[i], place(m) + "/" + std::to_string(i), *faults_, out[i], unknown_);
    }
    /// Relative path -> SHA-256, every path safe (safe_path.h), none the folder of another.
    void files(Member m, std::map<std::string, std::string>& out, CountRange count);

    /// Reads a whole object with all its faults.
    template <typename T>
    static void read(const Json& json, const std::string& pointer, Faults& faults, T& out,
                     Unknown unknown = Unknown::fault) {
        JsonReader reader(json, pointer, faults, unknown);
        describe(reader, out);
        reader.finish();
    }

private:
    const Json* member(const Member& m);
    std::string place(const Member& m) const;
    void refuse(const Json& value, std::string pointer, const std::string& rule);
    bool isListOf(const Json& value, const std::string& pointer, CountRange count);
    bool wholeNumber(const Json& value, const std::string& pointer, IntegerRange range, int64_t& out);
    bool readNumber(const Json& value, const std::string& pointer, double& out, NumberRange range);
    void readText(const Json& value, const std::string& pointer, std::string& out, TextLength length);
    bool readWord(const Json& value, const std::string& pointer, std::span<const std::string_view> words,
                  size_t& index);
    template <typename T, typename Read>
    void ifGiven(const Member& m, std::optional<T>& out, Read read) {
        T value{};
        read(value);
        if (object_ && object_->contains(m.name)) out = value;
    }
    template <typename T>
    void readInteger(const Json& value, const std::string& pointer, T& out, IntegerRange range) {
        int64_t read = 0;
        if (wholeNumber(value, pointer, range, read)) out = static_cast<T>(read);
    }
    void finish();

    const Json* object_;  // null if the value is no object
    std::string pointer_;
    Faults* faults_;
    Unknown unknown_;
    std::vector<std::string_view> known_;
};

/// Writes every member, also those that stand at their default.
class JsonWriter {
public:
    using Json = nlohmann::json;

    template <typename T>
    void integer(Member m, const T& value, IntegerRange) {
        json_[std::string(m.name)] = value;
    }
    template <std::floating_point T>
    void number(Member m, const T& value, NumberRange) {
        json_[std::string(m.name)] = shortest(value);
    }
    template <std::floating_point T>
    void triple(Member m, const std::array<T, 3>& value, NumberRange) {
        json_[std::string(m.name)] = {shortest(value[0]), shortest(value[1]), shortest(value[2])};
    }
    void flag(Member m, bool value) { json_[std::string(m.name)] = value; }
    void text(Member m, const std::string& value, TextLength) { json_[std::string(m.name)] = value; }
    void texts(Member m, const std::vector<std::string>& values, CountRange, TextLength) {
        json_[std::string(m.name)] = values;
    }
    template <typename Enum, size_t N>
    void choice(Member m, Enum value, const std::array<Choice<Enum>, N>& choices) {
        for (const auto& c : choices)
            if (c.value == value) json_[std::string(m.name)] = c.word;
    }
    void word(Member m, const std::string& value, std::span<const std::string_view>) {
        json_[std::string(m.name)] = value;
    }

    // Members without a default are written where they have a value.
    template <std::integral T>
    void givenInteger(Member m, const T& value, IntegerRange range) {
        if (value != 0) integer(m, value, range);
    }
    template <typename T>
    void number(Member m, const std::optional<T>& value, NumberRange range) {
        if (value) number(m, *value, range);
    }
    template <typename T>
    void triple(Member m, const std::optional<std::array<T, 3>>& value, NumberRange range) {
        if (value) triple(m, *value, range);
    }
    void flag(Member m, const std::optional<bool>& value) {
        if (value) flag(m, *value);
    }
    template <typename Enum, size_t N>
    void choice(Member m, const std::optional<Enum>& value, const std::array<Choice<Enum>, N>& choices) {
        if (value) choice(m, *value, choices);
    }
    void word(Member m, const std::optional<std::string>& value, std::span<const std::string_view> words) {
        if (value) word(m, *value, words);
    }
    template <typename T>
    void object(Member m, const T& value) {
        json_[std::string(m.name)] = write(value);
    }
    template <typename T>
    void list(Member m, const std::vector<T>& values, CountRange) {
        Json array = Json::array();
        for (const T& value : values) array.push_back(write(value));
        json_[std::string(m.name)] = std::move(array);
    }
    void files(Member m, const std::map<std::string, std::string>& value, CountRange) {
        json_[std::string(m.name)] = value;
    }

    template <typename T>
    static Json write(const T& value) {
        JsonWriter writer;
        describe(writer, value);
        return std::move(writer.json_);
    }

    /// 0.1f as 0.1, not as 0.10000000149011612; a reader of floats gets the same bits back.
    static double shortest(double value) { return value; }
    static double shortest(float value);

private:
    Json json_ = Json::object();
};

/// Describes the object as JSON Schema 2020-12, with the defaults of a fresh value.
class JsonSchema {
public:
    using Json = nlohmann::json;

    template <typename T>
    void integer(Member m, const T& value, IntegerRange r) {
        Json& p = property(m, {{"type", "integer"}, {"minimum", r.least}, {"maximum", r.most}});
        if (r.step != 1) p["multipleOf"] = r.step;
        if (!m.required) p["default"] = value;
    }
    template <std::floating_point T>
    void number(Member m, const T& value, NumberRange r) {
        Json& p = property(m, ofNumber(r));
        if (!m.required) p["default"] = JsonWriter::shortest(value);
    }
    template <std::floating_point T>
    void triple(Member m, const std::array<T, 3>& value, NumberRange r) {
        Json& p = property(m, ofTriple(r));
        const auto shortest = [&](size_t i) { return JsonWriter::shortest(value[i]); };
        if (!m.required) p["default"] = {shortest(0), shortest(1), shortest(2)};
    }
    void flag(Member m, bool value) { property(m, {{"type", "boolean"}, {"default", value}}); }
    void text(Member m, const std::string& value, TextLength length) {
        Json& p = property(m, ofText(length));
        if (!m.required) p["default"] = value;
    }
    void texts(Member m, const std::vector<std::string>& values, CountRange c, TextLength each) {
        property(m, {{"type", "array"},
                     {"items", ofText(each)},
                     {"minItems", c.least},
                     {"maxItems", c.most},
                     {"default", values}});
    }
    template <typename Enum, size_t N>
    void choice(Member m, Enum value, const std::array<Choice<Enum>, N>& choices) {
        Json& p = property(m, ofChoices(choices));
        for (const auto& c : choices)
            if (c.value == value && !m.required) p["default"] = c.word;
    }

    // Members without a default.
    template <std::integral T>
    void givenInteger(Member m, const T&, IntegerRange r) {
        property(m, {{"type", "integer"}, {"minimum", r.least}, {"maximum", r.most}});
    }
    template <typename T>
    void number(Member m, const std::optional<T>&, NumberRange r) {
        property(m, ofNumber(r));
    }
    template <typename T>
    void triple(Member m, const std::optional<std::array<T, 3>>&, NumberRange r) {
        property(m, ofTriple(r));
    }
    void flag(Member m, const std::optional<bool>&) { property(m, {{"type", "boolean"}}); }
    template <typename Enum, size_t N>
    void choice(Member m, const std::optional<Enum>&, const std::array<Choice<Enum>, N>& choices) {
        property(m, ofChoices(choices));
    }
    void word(Member m, const std::optional<std::string>&, std::span<const std::string_view> words) {
        property(m, {{"type", "string"}, {"enum", Json(words)}});
    }
    template <typename T>
    void object(Member m, const T& value) {
        property(m, schemaOf(value));
    }
    template <typename T>
    void list(Member m, const std::vector<T>&, CountRange c) {
        property(m,
                 {{"type", "array"}, {"items", schemaOf(T{})}, {"minItems", c.least}, {"maxItems", c.most}});
    }
    void files(Member m, const std::map<std::string, std::string>&, CountRange c) {
        property(m, {{"type", "object"},
                     {"additionalProperties", {{"type", "string"}, {"pattern", "^[0-9a-f]{64}$"}}},
                     {"minProperties", c.least},
                     {"maxProperties", c.most}});
    }

    template <typename T>
    static Json schemaOf(const T& value) {
        JsonSchema schema;
        describe(schema, value);
        return std::move(schema.json_);
    }

private:
    static Json ofText(TextLength length) {
        return {{"type", "string"}, {"minLength", length.least}, {"maxLength", length.most}};
    }
    static Json ofNumber(NumberRange r) {
        return {{"type", "number"}, {"minimum", r.least}, {"maximum", r.most}};
    }
    static Json ofTriple(NumberRange r) {
        return {{"type", "array"}, {"items", ofNumber(r)}, {"minItems", 3}, {"maxItems", 3}};
    }
    template <typename Enum, size_t N>
    static Json ofChoices(const std::array<Choice<Enum>, N>& choices) {
        Json words = Json::array();
        for (const auto& c : choices) words.push_back(c.word);
        return {{"type", "string"}, {"enum", words}};
    }
    Json& property(const Member& m, Json about);

    Json json_{{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
};

}  // namespace tilefarm
