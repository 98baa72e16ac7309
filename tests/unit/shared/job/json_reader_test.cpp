// The reader by itself, over a type that has a member of every kind.
#include "shared/job/json_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_error.h"

namespace tilefarm {

enum class Shape { sphere, cube };
inline constexpr std::array kShapes{Choice<Shape>{"sphere", Shape::sphere},
                                    Choice<Shape>{"cube", Shape::cube}};

struct Part {
    uint32_t id = 0;
};
struct Everything {
    int32_t whole = 5;
    float real = 0.5f;
    bool on = false;
    std::string text = "t";
    Shape shape = Shape::sphere;
    Part part;
    std::vector<Part> parts;
    std::array<float, 3> color{0.1f, 0.2f, 0.3f};
    std::optional<double> maybeReal;
    std::optional<bool> maybeOn;
    std::optional<Shape> maybeShape;
    std::optional<std::array<float, 3>> maybeColor;
    std::optional<std::string> maybeMetal;
};
inline constexpr std::array<std::string_view, 2> kMetals{"gold", "iron"};

template <typename Visitor>
void describe(Visitor& v, Is<Part> auto& part) {
    v.integer({"id", "", kRequired}, part.id, {1, 9});
}
template <typename Visitor>
void describe(Visitor& v, Is<Everything> auto& e) {
    v.integer({"whole", "a number"}, e.whole, {-8, 8, 1});
    v.number({"real", "metres"}, e.real, {0, 1});
    v.flag({"on", ""}, e.on);
    v.text({"text", ""}, e.text, {1, 4});
    v.choice({"shape", ""}, e.shape, kShapes);
    v.object({"part", ""}, e.part);
    v.list({"parts", ""}, e.parts, {0, 3});
    v.triple({"color", ""}, e.color, {0, 1});
    v.number({"maybeReal", ""}, e.maybeReal, {0, 1});
    v.flag({"maybeOn", ""}, e.maybeOn);
    v.choice({"maybeShape", ""}, e.maybeShape, kShapes);
    v.triple({"maybeColor", ""}, e.maybeColor, {0, 1});
    v.word({"maybeMetal", ""}, e.maybeMetal, kMetals);
}

namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

Everything read(const json& source) {
    Faults faults;
    Everything value;
    JsonReader::read(source, "", faults, value);
    faults.throwIfAny(ErrorCode::invalidArgument, "the thing");
    return value;
}

// Pointers of all faults, in order.
std::vector<std::string> readerFaultsOf(const json& source) {
    std::vector<std::string> pointers;
    for (const Fault& fault : errorOf([&] { read(source); }).faults) pointers.push_back(fault.pointer);
    return pointers;
}

TEST(JsonReader, ReadsEveryKindOfMember) {
    const Everything e = read(json::parse(R"({"whole": -3, "real": 0.25, "on": true, "text": "äöü",
        "shape": "cube", "part": {"id": 4}, "parts": [{"id": 1}, {"id": 2}]})"));
    EXPECT_EQ(e.whole, -3);
    EXPECT_EQ(e.real, 0.25f);
    EXPECT_TRUE(e.on);
    EXPECT_EQ(e.text, "äöü");
    EXPECT_EQ(e.shape, Shape::cube);
    EXPECT_EQ(e.part.id, 4u);
    EXPECT_EQ(e.parts.at(1).id, 2u);
}

TEST(JsonReader, KeepsDefaultsOfWhatIsLeftOut) {
    const Everything e = read(json::object());
    EXPECT_EQ(e.whole, 5);
    EXPECT_EQ(e.text, "t");
}

TEST(JsonReader, ListsEveryFaultWithItsPlace) {
    EXPECT_THAT(
        readerFaultsOf(json::parse(R"({"whole": 9, "real": "x", "on": 1, "text": "abcde", "shape": "cone",
        "part": [], "parts": [{"id": 1}, {"id": 0}, {}], "a/b": 1})")),
        ElementsAre("/whole", "/real", "/on", "/text", "/shape", "/part", "/parts/1/id", "/parts/2/id",
                    "/a~1b"));
}

TEST(JsonReader, TakesWholeNumbersHoweverTheyAreWritten) {
    EXPECT_EQ(read(json::parse(R"({"whole": 7.0})")).whole, 7);
    EXPECT_EQ(read(json::parse(R"({"whole": 0.7e1})")).whole, 7);
    for (const char* bad :
         {"7.5", "9", "-9", "1e300", "18446744073709551615", "\"7\"", "true", "null", "[7]"})
        EXPECT_THAT(readerFaultsOf(json::parse(std::string(R"({"whole": )") + bad + "}")),
                    ElementsAre("/whole"))
            << bad;
}

TEST(JsonReader, CountsCharactersNotBytesAndRefusesControlCharacters) {
    EXPECT_EQ(read({{"text", "日本語字"}}).text, "日本語字");
    EXPECT_THAT(readerFaultsOf({{"text", ""}}), ElementsAre("/text"));
    EXPECT_THAT(readerFaultsOf({{"text", "a\nb"}}), ElementsAre("/text"));
    EXPECT_THAT(readerFaultsOf({{"text", std::string("a\0b", 3)}}), ElementsAre("/text"));
}

TEST(JsonReader, SaysWhatWasWrong) {
    EXPECT_THAT(errorOf([] { read({{"whole", 9}}); }).what(), HasSubstr("whole number from -8 to 8, not 9"));
    EXPECT_THAT(errorOf([] {
                    read({{"shape", "cone"}});
                }).what(),
                HasSubstr("must be one of sphere, cube, not \"cone\""));
    EXPECT_THAT(errorOf([] { read({{"wole", 1}}); }).what(), HasSubstr("known here: whole, real"));
    EXPECT_THAT(errorOf([] { read(json::array()); }).what(), HasSubstr("must be an object, not a list of 0"));
    EXPECT_THAT(errorOf([] { read({{"whole", std::string(1000, 'x')}}); }).what(), HasSubstr("x…"));
}

TEST(JsonReader, StopsListingAtAHundredFaults) {
    json hostile;
    for (int i = 0; i < 10000; ++i) hostile["x" + std::to_string(i)] = i;
    const Error error = errorOf([&] { read(hostile); });
    EXPECT_EQ(error.faults.size(), 100u);
    EXPECT_THAT(error.what(), HasSubstr("more than 100 errors"));
}

TEST(JsonReader, CanPassOverUnknownMembers) {
    Faults faults;
    Part part;
    JsonReader::read(json{{"id", 2}, {"news", 1}}, "", faults, part, JsonReader::Unknown::ignore);
    EXPECT_NO_THROW(faults.throwIfAny(ErrorCode::invalidArgument, ""));
    EXPECT_EQ(part.id, 2u);
}

TEST(JsonWriter, WritesEveryMemberSoThatTheReaderTakesItBack) {
    Everything e;
    e.part.id = 1;
    e.shape = Shape::cube;
    e.parts = {{3}};
    const json written = JsonWriter::write(e);
    EXPECT_EQ(written.size(), 8u) << "those that may be left out are";
    EXPECT_EQ(written["color"].dump(), "[0.1,0.2,0.3]") << "the shortest that reads back";
    EXPECT_EQ(JsonWriter::write(read(written)), written);
    EXPECT_EQ(read(written).color, e.color);
}

TEST(JsonReader, ReadsMembersThatMayBeLeftOut) {
    const json source = json::parse(R"({"maybeReal": 0, "maybeOn": false, "maybeShape": "sphere",
                                        "maybeColor": [0, 0.5, 1], "maybeMetal": "iron"})");
    const Everything e = read(source);
    EXPECT_EQ(e.maybeReal, 0.0);
    EXPECT_EQ(e.maybeOn, false);
    EXPECT_EQ(e.maybeShape, Shape::sphere);
    EXPECT_EQ(e.maybeColor, (std::array<float, 3>{0, 0.5f, 1}));
    EXPECT_EQ(e.maybeMetal, "iron");
    json written = JsonWriter::write(e);
    for (const auto& [name, value] : source.items()) EXPECT_EQ(written[name], value);

    const Everything none = read(json::object());
    EXPECT_FALSE(none.maybeReal || none.maybeOn || none.maybeShape || none.maybeColor || none.maybeMetal);
}

TEST(JsonReader, NamesThePlaceOfFaultsInThem) {
    EXPECT_THAT(readerFaultsOf(json::parse(
                    R"({"color": [0, 2, "x"], "maybeReal": null, "maybeOn": 0, "maybeShape": "cone",
                                         "maybeColor": [0, 0], "maybeMetal": "tin"})")),
                ElementsAre("/color/1", "/color/2", "/maybeReal", "/maybeOn", "/maybeShape", "/maybeColor",
                            "/maybeMetal"));
    EXPECT_THAT(readerFaultsOf(json::parse(R"({"color": {}, "maybeColor": [1, 1, 1, 1], "maybeMetal": 7})")),
                ElementsAre("/color", "/maybeColor", "/maybeMetal"));
}

TEST(JsonSchema, TellsRangesDefaultsAndWhatIsRequired) {
    const json schema = JsonSchema::schemaOf(Everything{});
    EXPECT_EQ(
        schema["properties"]["whole"],
        json::parse(R"({"type":"integer","minimum":-8,"maximum":8,"default":5,"description":"a number"})"));
    EXPECT_EQ(schema["properties"]["shape"]["enum"], json::parse(R"(["sphere","cube"])"));
    EXPECT_EQ(schema["properties"]["color"],
              json::parse(R"({"type": "array", "items": {"type": "number", "minimum": 0.0, "maximum": 1.0},
                              "minItems": 3, "maxItems": 3, "default": [0.1, 0.2, 0.3]})"));
    EXPECT_EQ(schema["properties"]["maybeReal"],
              json::parse(R"({"type": "number", "minimum": 0.0, "maximum": 1.0})"));
    EXPECT_EQ(schema["properties"]["maybeMetal"],
              json::parse(R"({"type": "string", "enum": ["gold", "iron"]})"));
    EXPECT_FALSE(schema["properties"]["maybeShape"].contains("default"));
    EXPECT_EQ(schema["properties"]["part"]["required"], json::parse(R"(["id"])"));
    EXPECT_FALSE(schema.contains("required"));
    EXPECT_EQ(schema["additionalProperties"], false);
}

}  // namespace
}  // namespace tilefarm
