#include "shared/job/json_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "shared/digest/digest.h"
#include "shared/job/safe_path.h"
#include "shared/job/wire.h"

namespace tilefarm {

namespace {

using nlohmann::json;

constexpr size_t kMostFaults = 100;

// A value as a message quotes it: short, and one line.
std::string shown(const json& value) {
    if (value.is_object()) return "an object";
    if (value.is_array()) return fmt::format("a list of {}", value.size());
    std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
    constexpr size_t longest = 60;
    if (text.size() <= longest) return text;
    size_t end = longest;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
        --end;  // not inside a character
    return text.substr(0, end) + "…";
}

// JSON knows one kind of number: 64.0 and 6.4e1 are whole.
bool asWhole(const json& value, int64_t& out) {
    if (value.is_number_unsigned()) {
        if (value.get<uint64_t>() > uint64_t{std::numeric_limits<int64_t>::max()}) return false;
        out = value.get<int64_t>();
        return true;
    }
    if (value.is_number_integer()) {
        out = value.get<int64_t>();
        return true;
    }
    if (!value.is_number_float()) return false;
    const double number = value.get<double>();
    if (!(std::abs(number) <= 9007199254740992.0) || number != std::trunc(number)) return false;
    out = static_cast<int64_t>(number);
    return true;
}

size_t codePoints(std::string_view utf8) {
    return static_cast<size_t>(std::count_if(
        utf8.begin(), utf8.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

bool hasControlCharacter(std::string_view text) {
    return std::any_of(text.begin(), text.end(),
                       [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

}  // namespace

void Faults::add(std::string pointer, std::string message) {
    if (faults_.size() == kMostFaults) {
        cut_ = true;
        return;
    }
    faults_.push_back({std::move(pointer), std::move(message)});
}

void Faults::addBelow(const std::string& pointer, const Error& error) {
    for (const Fault& fault : error.faults) add(pointer + fault.pointer, fault.message);
    if (error.faults.empty()) add(pointer, error.what());
}

bool Faults::at(std::string_view pointer) const {
    return std::any_of(faults_.begin(), faults_.end(), [&](const Fault& fault) {
        return fault.pointer.starts_with(pointer) &&
               (fault.pointer.size() == pointer.size() || fault.pointer[pointer.size()] == '/');
    });
}

void Faults::throwIfAny(ErrorCode code, std::string_view what) const {
    if (faults_.empty()) return;
    const Fault& first = faults_.front();
    const std::string place = first.pointer.empty() ? "the document" : first.pointer;
    const std::string count =
        cut_ ? fmt::format("more than {}", kMostFaults) : std::to_string(faults_.size());
    const std::string sentence = faults_.size() == 1 ? fmt::format("{}: {} {}", what, place, first.message)
                                                     : fmt::format("{} has {} errors; the first: {} {}", what,
                                                                   count, place, first.message);
    throw Error(code, sentence, faults_);
}

JsonReader::JsonReader(const Json& object, std::string pointer, Faults& faults, Unknown unknown)
    : object_(object.is_object() ? &object : nullptr),
      pointer_(std::move(pointer)),
      faults_(&faults),
      unknown_(unknown) {
    if (!object_) refuse(object, pointer_, "must be an object");
}

std::string JsonReader::place(const Member& m) const {
    return pointer_ + "/" + pointerToken(m.name);
}

const json* JsonReader::member(const Member& m) {
    known_.push_back(m.name);
    if (!object_) return nullptr;
    if (const auto found = object_->find(m.name); found != object_->end()) return &*found;
    if (m.required) faults_->add(place(m), "is missing");
    return nullptr;
}

void JsonReader::refuse(const Json& value, std::string pointer, const std::string& rule) {
    faults_->add(std::move(pointer), rule + ", not " + shown(value));
}

void JsonReader::finish() {
    if (!object_ || unknown_ == Unknown::ignore) return;
    for (const auto& [name, value] : object_->items())
        if (std::find(known_.begin(), known_.end(), name) == known_.end())
            faults_->add(pointer_ + "/" + pointerToken(name),
                         fmt::format("is unknown; known here: {}", fmt::join(known_, ", ")));
}

void JsonReader::flag(Member m, bool& out) {
    const json* value = member(m);
    if (!value) return;
    if (!value->is_boolean()) return refuse(*value, place(m), "must be true or false");
    out = value->get<bool>();
}

void JsonReader::text(Member m, std::string& out, TextLength length) {
    if (const json* value = member(m)) readText(*value, place(m), out, length);
}

void JsonReader::texts(Member m, std::vector<std::string>& out, CountRange count, TextLength each) {
    const json* value = member(m);
    if (!value || !isListOf(*value, place(m), count)) return;
    out.assign(value->size(), {});
    for (size_t i = 0; i < out.size(); ++i)
        readText((*value)[i], place(m) + "/" + std::to_string(i), out[i], each);
}

void JsonReader::readText(const Json& value, const std::string& pointer, std::string& out,
                          TextLength length) {
    if (!value.is_string()) return refuse(value, pointer, "must be a string");
    const auto& text = value.get_ref<const std::string&>();
    if (const size_t n = codePoints(text); n < length.least || n > length.most)
        return faults_->add(
            pointer, fmt::format("must have {} to {} characters, not {}", length.least, length.most, n));
    if (hasControlCharacter(text)) return faults_->add(pointer, "must not have control characters");
    out = text;
}

bool JsonReader::wholeNumber(const Json& value, const std::string& pointer, IntegerRange range,
                             int64_t& out) {
    if (asWhole(value, out) && out >= range.least && out <= range.most && out % range.step == 0) return true;
    const std::string multiple = range.step == 1 ? "" : fmt::format(" that is a multiple of {}", range.step);
    refuse(value, pointer,
           fmt::format("must be a whole number from {} to {}{}", range.least, range.most, multiple));
    return false;
}

bool JsonReader::readNumber(const Json& value, const std::string& pointer, double& out, NumberRange range) {
    const double number = value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (number >= range.least && number <= range.most) {
        out = number;
        return true;
    }
    refuse(value, pointer, fmt::format("must be a number from {} to {}", range.least, range.most));
    return false;
}

bool JsonReader::readWord(const Json& value, const std::string& pointer,
                          std::span<const std::string_view> words, size_t& index) {
    if (value.is_string()) {
        const auto found =
            std::find(words.begin(), words.end(), std::string_view(value.get_ref<const std::string&>()));
        index = static_cast<size_t>(found - words.begin());
        if (found != words.end()) return true;
    }
    refuse(value, pointer, fmt::format("must be one of {}", fmt::join(words, ", ")));
    return false;
}

void JsonReader::word(Member m, std::string& out, std::span<const std::string_view> words) {
    const json* value = member(m);
    size_t index = 0;
    if (value && readWord(*value, place(m), words, index)) out = words[index];
}

bool JsonReader::isListOf(const Json& value, const std::string& pointer, CountRange count) {
    if (value.is_array() && value.size() >= count.least && value.size() <= count.most) return true;
    refuse(value, pointer, fmt::format("must be a list of {} to {}", count.least, count.most));
    return false;
}

void JsonReader::files(Member m, std::map<std::string, std::string>& out, CountRange count) {
    const json* value = member(m);
    if (!value) return;
    if (!value->is_object() || value->size() < count.least || value->size() > count.most)
        return refuse(
            *value, place(m),
            fmt::format("must be an object of {} to {} files, path -> SHA-256", count.least, count.most));
    for (const auto& [path, digest] : value->items()) {
        const std::string pointer = place(m) + "/" + pointerToken(path);
        if (std::string fault = pathFault(path); !fault.empty()) faults_->add(pointer, std::move(fault));
        out[path] = digest.is_string() ? digest.get<std::string>() : "";
        if (!isSha256Hex(out[path])) refuse(digest, pointer, "must be a SHA-256 of 64 lower-case hex digits");
        for (size_t slash = path.find('/'); slash != std::string::npos; slash = path.find('/', slash + 1))
            if (value->contains(path.substr(0, slash)))
                faults_->add(pointer, "lies in '" + path.substr(0, slash) + "', which is itself a file");
    }
}

double JsonWriter::shortest(float value) {
    return std::stod(fmt::format("{}", value));
}

JsonSchema::Json& JsonSchema::property(const Member& m, Json about) {
    if (!m.meaning.empty()) about["description"] = m.meaning;
    if (m.required) json_["required"].push_back(m.name);
    return json_["properties"][std::string(m.name)] = std::move(about);
}

}  // namespace tilefarm
