#include "shared/job/job_options.h"

#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "shared/job/wire.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

JobSpec parsed(std::vector<std::string> words) {
    CLI::App app;
    JobSpec spec;
    addJobOptions(app, spec);
    std::reverse(words.begin(), words.end());
    app.parse(words);
    return spec;
}

TEST(JobOptions, SetEveryFieldOfAJob) {
    const JobSpec spec = parsed({"--name",        "n",  "--camera",         "Cam", "--width",   "100",
                                 "--height",      "50", "--tile-size",      "16",  "--seed",    "4294967295",
                                 "--max-bounces", "3",  "--roulette-start", "2",   "--samples", "7",
                                 "--priority",    "9",  "--frames",         "3-5"});
    JobSpec expected;
    expected.name = "n", expected.camera = "Cam";
    expected.image = {100, 50, 16};
    expected.settings.seed = 4294967295u;
    expected.settings.maxBounces = 3;
    expected.settings.rouletteStart = 2;
    expected.stop.samples = 7;
    expected.priority = 9;
    expected.frames = {3, 3};
    EXPECT_EQ(spec, expected);
}

TEST(JobOptions, SetChoicesAndNestedMembers) {
    const JobSpec spec = parsed({"--light-selection",
                                 "tree",
                                 "--direct-light",
                                 "lights",
                                 "--microfacets",
                                 "beckmann",
                                 "--fresnel",
                                 "schlick",
                                 "--no-energy-compensation",
                                 "--environment-kind",
                                 "sky",
                                 "--environment-rotation",
                                 "-90",
                                 "--environment-intensity",
                                 "2",
                                 "--no-environment-visible",
                                 "--sky-sun-elevation",
                                 "30",
                                 "--sky-turbidity",
                                 "3",
                                 "--variant",
                                 "dusk",
                                 "--strict"});
    JobSpec expected;
    expected.settings.lightSelection = LightSelection::tree;
    expected.settings.directLight = DirectLight::lights;
    expected.settings.microfacets = Microfacets::beckmann;
    expected.settings.fresnel = Fresnel::schlick;
    expected.settings.energyCompensation = false;
    expected.environment.kind = EnvironmentKind::sky;
    expected.environment.rotation = -90;
    expected.environment.intensity = 2;
    expected.environment.visible = false;
    expected.environment.sky.sunElevation = 30;
    expected.environment.sky.turbidity = 3;
    expected.variant = "dusk";
    expected.strict = true;
    EXPECT_EQ(spec, expected);
    EXPECT_EQ(parsed({"--environment-color", "1", "0.5", "0"}).environment.color, (Color{1, 0.5f, 0}));
    EXPECT_TRUE(parsed({"--environment-visible"}).environment.visible);
    FogSettings fog{{0.1f, 0.2f, 0.3f}, {1, 1, 1}, 0.5, {{-1, -2, -3}}, {{1, 2, 3}}};
    EXPECT_EQ(parsed({"--fog-extinction", "0.1", "0.2", "0.3", "--fog-anisotropy", "0.5", "--fog-min", "-1",
                      "-2", "-3", "--fog-max", "1", "2", "3"})
                  .fog,
              fog);
}

TEST(JobOptions, TakeListsAsJsonOrFromFiles) {
    const TemporaryFolder folder;
    const std::string file = (folder / "lights.json").string();
    std::ofstream(file) << R"([{"kind": "point", "intensity": 3}, {"kind": "sphere"}])";
    const JobSpec spec = parsed({"--material", R"({"material": "Gold", "conductor": "gold"})", "--light",
                                 file, "--light", R"([{"kind": "quad"}, {"kind": "spot"}])", "--material",
                                 R"({"material": "*", "roughness": 0.5})"});
    ASSERT_EQ(spec.materials.size(), 2u);
    EXPECT_EQ(spec.materials[0].conductor, "gold");
    EXPECT_EQ(spec.materials[1].roughness, 0.5f);
    ASSERT_EQ(spec.lights.size(), 4u);
    EXPECT_EQ(spec.lights[0].intensity, 3);
    EXPECT_EQ(spec.lights[1].kind, LightKind::sphere);
    EXPECT_EQ(spec.lights[3].kind, LightKind::spot);
}

std::string refusal(std::vector<std::string> words) {
    try {
        parsed(std::move(words));
    } catch (const CLI::ParseError& error) {
        return error.what();
    }
    return "taken";
}

TEST(JobOptions, SayWhatIsWrongWithAList) {
    using testing::HasSubstr;
    EXPECT_THAT(refusal({"--material", R"({"material": "a", "roughness": 2, "conductor": "tin"})"}),
                testing::AllOf(HasSubstr("/roughness must be a number from 0 to 1"),
                               HasSubstr("/conductor must be one of gold")));
    EXPECT_THAT(refusal({"--light", R"([{"kind": "point"}, {"kind": "lamp"}])"}),
                HasSubstr("/1/kind must be one of"));
    EXPECT_THAT(refusal({"--light", "{\"kind\": "}), HasSubstr("line 1"));
    EXPECT_THAT(refusal({"--light", "no-such-file.json"}), HasSubstr("no-such-file.json"));
    EXPECT_THAT(refusal({"--light-selection", "best"}), HasSubstr("tree"));
}

TEST(PictureOptions, LeaveOutWhatOnlyAFarmAsksFor) {
    CLI::App app;
    JobSpec spec;
    addPictureOptions(app, spec);
    EXPECT_EQ(app.get_option_no_throw("--priority"), nullptr);
    EXPECT_EQ(app.get_option_no_throw("--frames"), nullptr);
    EXPECT_NE(app.get_option_no_throw("--samples"), nullptr);
    EXPECT_NE(app.get_option_no_throw("--sky-altitude"), nullptr);
}

TEST(JobOptions, KeepTheDefaultsOfTheApi) {
    const JobSpec usual;
    EXPECT_EQ(parsed({}), usual);
}

TEST(JobOptions, RefuseWhatIsOutOfRange) {
    for (const char* words : {"--width=0", "--width=32769", "--width=-1", "--width=x", "--samples=0",
                              "--priority=101", "--frames=x", "--sampels=1"})
        EXPECT_THROW(parsed({words}), CLI::ParseError) << words;
}

// Every member of the schema as docs/jobs.md writes it: settings.seed, lights[].kind.
void collectMembers(const nlohmann::json& schema, const std::string& prefix, std::vector<std::string>& out) {
    if (schema.contains("properties") && schema["type"] == "object")
        for (const auto& [name, member] : schema["properties"].items())
            collectMembers(member, prefix.empty() ? name : prefix + "." + name, out);
    else if (schema["type"] == "array" && schema["items"]["type"] == "object")
        collectMembers(schema["items"], prefix + "[]", out);
    else
        out.push_back(prefix);
}

std::string tablesOf(const std::string& file) {
    std::ifstream in(file);
    std::string tables;
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("|")) tables += line + "\n";
    return tables;
}

TEST(Documents, HaveEveryKnobInItsTables) {
    const std::string tables = tablesOf(TILEFARM_SOURCE_DIR "/docs/jobs.md");
    std::vector<std::string> members;
    collectMembers(jobSchema(), "", members);
    EXPECT_GT(members.size(), 60u);
    for (const std::string& member : members)
        EXPECT_THAT(tables, testing::HasSubstr("`" + member + "`")) << "not in a table of docs/jobs.md";

    CLI::App app;
    JobSpec spec;
    addJobOptions(app, spec);
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) {
            if (name == "help") continue;
            const bool found = tables.find("`--" + name + "`") != std::string::npos ||
                               tables.find("`--" + name + " ") != std::string::npos;
            EXPECT_TRUE(found) << "--" << name << " is not in a table of docs/jobs.md";
        }
}

// Every member of the schema that has no description.
void collectUndescribed(const nlohmann::json& schema, const std::string& place,
                        std::vector<std::string>& out) {
    if (!place.empty() && schema.value("description", "").empty()) out.push_back(place);
    if (schema.contains("properties"))
        for (const auto& [name, member] : schema["properties"].items())
            collectUndescribed(member, place + "/" + name, out);
    if (schema.contains("items") && schema["items"].value("type", "") == "object")
        for (const auto& [name, member] : schema["items"]["properties"].items())
            collectUndescribed(member, place + "[]/" + name, out);
}

TEST(Documents, DescribeEveryMemberAndOption) {
    std::vector<std::string> undescribed;
    collectUndescribed(jobSchema(), "", undescribed);
    EXPECT_THAT(undescribed, testing::IsEmpty());

    CLI::App app;
    JobSpec spec;
    addJobOptions(app, spec);
    for (const CLI::Option* option : app.get_options())
        EXPECT_NE(option->get_description(), "") << option->get_name();
}

TEST(JobOptions, TakeFramesByListAndStep) {
    EXPECT_EQ(parsed({"--frames", "1-100x10"}).frames, (FrameSet{1, 10, 10}));
    EXPECT_EQ(parsed({"--frames", "1,5,9"}).frames, (FrameSet{1, 3, 1, "1,5,9"}));
}

TEST(JobOptions, LeaveTheSizeOpenUnlessItIsGiven) {
    EXPECT_EQ(parsed({}).image, (ImageSpec{0, 0, 128}));
    EXPECT_EQ(parsed({"--width", "100"}).image, (ImageSpec{100, 0, 128}));
}

TEST(OptionName, SplitsCamelCase) {
    EXPECT_EQ(optionName("samples"), "--samples");
    EXPECT_EQ(optionName("maxBounces"), "--max-bounces");
}

}  // namespace
}  // namespace tilefarm
