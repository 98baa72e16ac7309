#include "server/cli/job_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <charconv>
#include <regex>

#include "shared/job/fields.h"

namespace tilefarm {

namespace {

// Visits the fields of a job (json_reader.h) and makes an option of each.
class OptionMaker {
public:
    explicit OptionMaker(CLI::App& app) : app_(app) {}

    template <typename T>
    void integer(Member m, T& value, IntegerRange range) {
        app_.add_option(optionName(m.name), value, std::string(m.meaning))
            ->capture_default_str()
            ->check(CLI::Range(range.least, range.most));
    }
    template <typename T>
    void number(Member m, T& value, NumberRange range) {
        app_.add_option(optionName(m.name), value, std::string(m.meaning))
            ->capture_default_str()
            ->check(CLI::Range(range.least, range.most));
    }
    void flag(Member m, bool& value) {
        const std::string name = optionName(m.name);
        app_.add_flag(name + ",!--no-" + name.substr(2), value, std::string(m.meaning));
    }
    void text(Member m, std::string& value, TextLength) {
        app_.add_option(optionName(m.name), value, std::string(m.meaning))->capture_default_str();
    }
    template <typename Enum, size_t N>
    void choice(Member m, Enum& value, const std::array<Choice<Enum>, N>& choices) {
        std::map<std::string, Enum> words;
        for (const auto& c : choices) words[std::string(c.word)] = c.value;
        app_.add_option(optionName(m.name), value, std::string(m.meaning))
            ->transform(CLI::CheckedTransformer(words));
    }
    template <typename T>
    void object(Member, T& value) {
        describe(*this, value);
    }
    // The command line says these its own way.
    void object(Member, SceneBundle&) {}
    void object(Member, FrameRange&) {}

private:
    CLI::App& app_;
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

FrameRange framesFrom(const std::string& text) {
    static const std::regex form("(-?[0-9]{1,10})(?:-(-?[0-9]{1,10}))?");
    std::smatch parts;
    if (!std::regex_match(text, parts, form))
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("--frames '{}' must be a frame or a range like 1-240", text));
    const int64_t first = std::stoll(parts[1]), last = parts[2].matched ? std::stoll(parts[2]) : first;
    if (last < first || last - first >= 100000 || first < INT32_MIN || last > INT32_MAX)
        throw Error(ErrorCode::invalidArgument,
                    fmt::format("--frames '{}' must hold 1 to 100000 frames", text));
    return {static_cast<int32_t>(first), static_cast<uint32_t>(last - first + 1)};
}

void addJobOptions(CLI::App& app, JobSpec& spec) {
    OptionMaker maker(app);
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
        "a frame, or a range like 1-240");
}

}  // namespace tilefarm
