#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "shared/job/wire.h"
#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string faultOf(const std::string& text) {
    const Error error = errorOf([&] { parseJson(text); });
    EXPECT_EQ(error.code, ErrorCode::invalidArgument);
    return error.what();
}

TEST(ParseJson, GivesTheValue) {
    EXPECT_EQ(parseJson(R"( {"a": [1, -2.5, true, null, "ü"]} )").dump(), R"({"a":[1,-2.5,true,null,"ü"]})");
    EXPECT_EQ(parseJson("18446744073709551615").get<uint64_t>(), UINT64_MAX);
}

TEST(ParseJson, SaysLineAndColumnOfAFault) {
    EXPECT_THAT(faultOf(""), StartsWith("line 1, column 1: "));
    EXPECT_THAT(faultOf("{\n  \"a\": 1,\n  \"b\": ]\n}"), StartsWith("line 3, column 8: "));
    EXPECT_THAT(faultOf("[1, 2"), StartsWith("line 1, column 6: "));
    EXPECT_THAT(faultOf("{} x"), StartsWith("line 1, column 4: "));
    EXPECT_THAT(faultOf("[1,]"), StartsWith("line 1, column 4: "));
}

TEST(ParseJson, RefusesDuplicateKeysOfOneObject) {
    EXPECT_THAT(faultOf("{\"a\": 1,\n \"b\": {\"a\": 2},\n \"a\": 3}"),
                StartsWith("line 3, column 2: the same member"));
    EXPECT_THAT(faultOf(R"({"a\"": 1, "a\u0022": 2})"), StartsWith("line 1, column 12: the same member"));
    EXPECT_NO_THROW(parseJson(R"([{"a": 1}, {"a": 2}, {"b": {"a": 1}, "a": 1}])"));
}

TEST(ParseJson, RefusesDeepNesting) {
    const auto nested = [](size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
    EXPECT_NO_THROW(parseJson(nested(64)));
    EXPECT_THAT(faultOf(nested(65)), StartsWith("line 1, column 65: nested deeper"));
    EXPECT_THAT(faultOf(std::string(10'000'000, '[')), HasSubstr("nested deeper"));
}

TEST(ParseJson, ObeysOtherRules) {
    const JsonRules rules{.repeatedNames = true, .deepest = 3};
    EXPECT_EQ(parseJson(R"({"a": 1, "a": 2})", rules)["a"], 2);
    EXPECT_NO_THROW(parseJson("[[[]]]", rules));
    EXPECT_THAT(errorOf([&] { parseJson("[[[[]]]]", rules); }).what(), HasSubstr("nested deeper than 3"));
}

TEST(ParseJson, RefusesNumbersThatNoDoubleHoldsAndWordsThatAreNone) {
    EXPECT_THAT(faultOf("[1e999]"), HasSubstr("1e999"));
    faultOf("[NaN]");
    faultOf("[Infinity]");
    faultOf("[01]");
    faultOf("[+1]");
    faultOf("[.5]");
    faultOf("[0x10]");
    faultOf("[1] // comment");
}

TEST(ParseJson, RefusesInvalidUtf8AndSaysSoInAscii) {
    for (const char* text : {"\"\xff\"", "\"\xc0\xaf\"", "\"\xed\xa0\x80\"", "\"\xe2\x82\"", "\"\\ud800\""}) {
        const std::string fault = faultOf(text);
        EXPECT_TRUE(std::all_of(fault.begin(), fault.end(), [](char c) {
            return static_cast<unsigned char>(c) < 128;
        })) << fault;
    }
}

TEST(ParseJson, KeepsAMessageShortHoweverLongTheFaultyToken) {
    EXPECT_LT(faultOf("\"" + std::string(1'000'000, 'x')).size(), 300u);
}

TEST(PointerToken, EscapesAsRfc6901Says) {
    EXPECT_EQ(pointerToken("a/b~c"), "a~1b~0c");
    EXPECT_EQ(pointerToken("~1"), "~01");
}

}  // namespace
}  // namespace tilefarm
