#include "shared/job/job_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "shared/file/durable_file.h"
#include "shared/job/fields.h"
#include "shared/job/wire.h"

namespace tilefarm {

namespace {

std::string sentencesOf(const Error& error) {
    if (error.faults.empty()) return error.what();
    std::string text;
    for (const Fault& fault : error.faults)
        text += (text.empty() ? "" : "; ") + fault.pointer + " " + fault.message;
    return text;
}

// The JSON of an option: right there, or in a file.
nlohmann::json jsonOf(const std::string& word) {
    const size_t first = word.find_first_not_of(" \t\r\n");
    if (first != std::string::npos && (word[first] == '{' || word[first] == '[')) return parseJson(word);
    const std::vector<std::byte> bytes = readWhole(word);
    return parseJson({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

// One object or a list of them, appended to what there is.
template <typename T>
void append(const std::string& word, std::vector<T>& values) {
    try {
        nlohmann::json json = jsonOf(word);
        if (json.is_object()) json = nlohmann::json::array({std::move(json)});
        if (!json.is_array()) throw Error(ErrorCode::invalidArgument, "must be an object or a list of them");
        Faults faults;
        for (size_t i = 0; i < json.size(); ++i)
            JsonReader::read(json[i], json.size() == 1 ? "" : "/" + std::to_string(i), faults,
                             values.emplace_back());
        faults.throwIfAny(ErrorCode::invalidArgument, word);
    } catch (const Error& error) {
        throw CLI::ValidationError(sentencesOf(error));
    }
}

// Visits the fields of a job (json_reader.h) and makes an option of each.
class OptionMaker {
public:
    OptionMaker(CLI::App& app, bool ofFarm) : app_(app), ofFarm_(ofFarm) {}

    template <typename T>
    void integer(Member m, T& value, IntegerRange range) {
        if (!wanted(m)) return;
        app_.add_option(nameOf(m), value, std::string(m.meaning))
            ->capture_default_str()
            ->check(CLI::Range(range.least, range.most));
    }
    template <typename T>
    void givenInteger(Member m, T& value, IntegerRange range) {
        app_.add_option(nameOf(m), value, std::string(m.meaning))->check(CLI::Range(range.least, range.most));
    }
    template <typename T>
    void number(Member m, T& value, NumberRange range) {
        app_.add_option(nameOf(m), value, std::string(m.meaning))
            ->capture_default_str()
            ->check(CLI::Range(range.least, range.most));
    }
    template <typename T>
    void triple(Member m, std::array<T, 3>& value, NumberRange range) {
        const auto take = [&value](const std::vector<T>& given) {
            std::copy_n(given.begin(), 3, value.begin());
        };
        app_.add_option_function<std::vector<T>>(nameOf(m), take, std::string(m.meaning))
            ->expected(3)
            ->default_str(fmt::format("{}", fmt::join(value, " ")))
            ->check(CLI::Range(range.least, range.most));
    }
    template <typename T>
    void triple(Member m, std::optional<std::array<T, 3>>& value, NumberRange range) {
        const auto take = [&value](const std::vector<T>& given) {
            std::copy_n(given.begin(), 3, value.emplace().begin());
        };
        app_.add_option_function<std::vector<T>>(nameOf(m), take, std::string(m.meaning))
            ->expected(3)
            ->check(CLI::Range(range.least, range.most));
    }
    void flag(Member m, bool& value) {
        const std::string name = nameOf(m);
        app_.add_flag(name + ",!--no-" + name.substr(2), value, std::string(m.meaning))
            ->default_str(value ? "true" : "false");
    }
    void text(Member m, std::string& value, TextLength) {
        if (!wanted(m)) return;
        app_.add_option(nameOf(m), value, std::string(m.meaning))->capture_default_str();
    }
    template <typename Enum, size_t N>
    void choice(Member m, Enum& value, const std::array<Choice<Enum>, N>& choices) {
        std::vector<std::string> words;
        std::string usual;
        for (const auto& c : choices) {
            words.emplace_back(c.word);
            if (c.value == value) usual = c.word;
        }
        const auto take = [&value, choices](const std::string& word) {
            for (const auto& c : choices)
                if (c.word == word) value = c.value;
        };
        app_.add_option_function<std::string>(nameOf(m), take, std::string(m.meaning))
            ->default_str(usual)
            ->check(CLI::IsMember(words));
    }
    template <typename T>
    void list(Member m, std::vector<T>& values, CountRange) {
        std::string one(m.name);
        one.pop_back();  // lights -> --light
        app_.add_option_function<std::vector<std::string>>(
                optionName(one),
                [&values](const std::vector<std::string>& words) {
                    for (const std::string& word : words) append(word, values);
                },
                std::string(m.meaning) + ": a JSON object or list, or a file with one; may be repeated")
            ->allow_extra_args(false)  // one for each option; CLI11 then leaves brackets alone
            ->type_name("JSON|FILE");
    }
    template <typename T>
    void object(Member, T& value) {
        describe(*this, value);
    }
    // Their members have names that would say too little by themselves.
    void object(Member, EnvironmentSettings& value) { within("environment-", value); }
    void object(Member, SkySettings& value) { within("sky-", value); }
    void object(Member, FogSettings& value) { within("fog-", value); }
    void object(Member, ViewSettings& value) { within("view-", value); }
    void object(Member, OutputSettings& value) { within("output-", value); }
    // The command line says these its own way.
    void object(Member, SceneBundle&) {}
    void object(Member, FrameSet&) {}

private:
    std::string nameOf(const Member& m) const {
        const std::string name = "--" + prefix_ + optionName(m.name).substr(2);
        return m.name == "relativeError" ? name + ",--error" : name;  // the condition that is asked for most
    }
    bool wanted(const Member& m) const { return ofFarm_ || (m.name != "name" && m.name != "priority"); }
    void within(const char* prefix, auto& value) {
        const std::string outer = std::exchange(prefix_, prefix);
        describe(*this, value);
        prefix_ = outer;
    }

    CLI::App& app_;
    bool ofFarm_;
    std::string prefix_;
};

}  // namespace

std::string optionName(std::string_view member) {
    std::string name = "--";
    for (const char c : member) {
        if (std::isupper(static_cast<unsigned char>(c))) name += '-';
        name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return name;
}

void addPictureOptions(CLI::App& app, JobSpec& spec) {
    OptionMaker maker(app, false);
    describe(maker, spec);
}

void addJobOptions(CLI::App& app, JobSpec& spec) {
    OptionMaker maker(app, true);
    describe(maker, spec);
    app.add_option_function<std::string>(
        "--frames",
        [&spec](const std::string& text) {
            try {
                spec.frames = framesFrom(text);
            } catch (const Error& e) {
                throw CLI::ValidationError(e.what());
            }
        },
        "frame numbers and ranges: 7, 1-240, 1-100x10 (every tenth), 1,5,9");
}

}  // namespace tilefarm
