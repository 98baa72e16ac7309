// Text -> JSON, strictly. The parser proper is nlohmann's; a first pass through its SAX interface adds
// what RFC 8259 leaves to the reader: duplicate keys, depth, numbers no double holds, and a place.
#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "shared/job/wire.h"

namespace tilefarm {

namespace {

using nlohmann::json;

// Reads the text and counts how far the parser got, which its SAX interface does not say.
struct CountingIterator {
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    const char* at = nullptr;
    size_t* taken = nullptr;

    reference operator*() const { return *at; }
    CountingIterator& operator++() {
        ++at;
        ++*taken;
        return *this;
    }
    CountingIterator operator++(int) {
        auto before = *this;
        ++*this;
        return before;
    }
    friend bool operator==(const CountingIterator& a, const CountingIterator& b) { return a.at == b.at; }
};

[[noreturn]] void fail(std::string_view text, size_t offset, std::string_view fault) {
    const std::string_view before = text.substr(0, std::min(offset, text.size()));
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const size_t column = before.size() - (before.rfind('\n') + 1) + 1;  // npos + 1 is 0
    throw Error(ErrorCode::invalidArgument, fmt::format("line {}, column {}: {}", line, column, fault));
}

// Where the string token that ends just before `end` begins. Its inner quotes all stand after an odd
// number of backslashes.
size_t stringStart(std::string_view text, size_t end) {
    for (size_t i = end - 1; i-- > 0;) {
        if (text[i] != '"') continue;
        size_t slashes = 0;
        while (slashes < i && text[i - 1 - slashes] == '\\') ++slashes;
        if (slashes % 2 == 0) return i;
    }
    return 0;
}

// nlohmann's words without its prefix; they quote the input, which may be long and not even UTF-8.
std::string explain(std::string_view what) {
    if (const size_t place = what.find(": "); what.find("parse error at") != what.npos && place != what.npos)
        what.remove_prefix(place + 2);
    else if (const size_t name = what.find("] "); name != what.npos)
        what.remove_prefix(name + 2);
    std::string words(what.substr(0, 200));
    if (what.size() > words.size()) words += " …";
    // The ellipsis is ours; everything else beyond ASCII is not known to be whole.
    std::replace_if(
        words.begin(), words.begin() + static_cast<std::ptrdiff_t>(std::min(what.size(), size_t{200})),
        [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
    return words;
}

class StrictChecker : public nlohmann::json_sax<json> {
public:
    StrictChecker(std::string_view text, const size_t& taken, const JsonRules& rules)
        : text_(text), taken_(taken), rules_(rules) {}

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool string(string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool start_object(size_t) override { return enter(); }
    bool start_array(size_t) override { return enter(); }
    bool end_object() override { return leave(); }
    bool end_array() override { return leave(); }
    bool key(string_t& name) override {
        if (!rules_.repeatedNames && !keys_.back().insert(name).second)
            fail(text_, stringStart(text_, taken_), "the same member name stands twice in one object");
        return true;
    }
    bool parse_error(size_t position, const std::string&, const nlohmann::detail::exception& e) override {
        fail(text_, position == 0 ? 0 : position - 1, explain(e.what()));
    }

private:
    bool enter() {
        if (keys_.size() == rules_.deepest)
            fail(text_, taken_ - 1, fmt::format("nested deeper than {} levels", rules_.deepest));
        keys_.emplace_back();
        return true;
    }
    bool leave() {
        keys_.pop_back();
        return true;
    }

    std::string_view text_;
    const size_t& taken_;
    const JsonRules& rules_;
    std::vector<std::set<std::string>> keys_;  // of the objects that are open; arrays have none
};

}  // namespace

json parseJson(std::string_view text, const JsonRules& rules) {
    size_t taken = 0;
    StrictChecker checker(text, taken, rules);
    json::sax_parse(CountingIterator{text.data(), &taken},
                    CountingIterator{text.data() + text.size(), &taken}, &checker);
    return json::parse(text);
}

std::string pointerToken(std::string_view member) {
    std::string token;
    for (const char c : member) {
        if (c == '~')
            token += "~0";
        else if (c == '/')
            token += "~1";
        else
            token += c;
    }
    return token;
}

}  // namespace tilefarm
