#include "server/api/http.h"

#include <gtest/gtest.h>

#include "server/api/problem.h"
#include "tests/support/expect_error.h"

namespace tilefarm {
namespace {

HttpRequest requestWith(std::map<std::string, std::string> headers) {
    HttpRequest request;
    request.header = [headers](const std::string& name) {
        const auto at = headers.find(name);
        return at == headers.end() ? std::string{} : at->second;
    };
    return request;
}

int statusOf(const std::string& range, uint64_t bytes = 10) {
    return contentResponse(requestWith({{"Range", range}}), "text/plain", "tag", {bytes, [](auto, auto) {}})
        .status;
}

TEST(ContentResponse, IgnoresRangesItDoesNotUnderstand) {
    for (const char* range : {"", "bytes", "bytes=", "bytes=-", "bytes=a-b", "bytes=5-4", "items=0-1",
                              "bytes=0-1,3-4", "bytes=99999999999999999999-"}) {
        EXPECT_EQ(statusOf(range), 200) << range;
    }
}

TEST(ContentResponse, CutsRangesToWhatIsThere) {
    for (const char* range : {"bytes=0-0", "bytes=9-", "bytes=3-99", "bytes=-3", "bytes=-99"}) {
        EXPECT_EQ(statusOf(range), 206) << range;
    }
    EXPECT_EQ(statusOf("bytes=10-"), 416);
    EXPECT_EQ(statusOf("bytes=-0"), 416);
    EXPECT_EQ(statusOf("bytes=0-", 0), 416);
}

TEST(HttpRequest, StopsReadingABodyBeyondItsLimit) {
    HttpRequest request = requestWith({});
    request.stream = [](const HttpRequest::Consumer& consumer) {
        const std::string piece(100, 'x');
        for (int i = 0; i < 3; ++i) consumer(std::as_bytes(std::span(piece)));
    };
    EXPECT_EQ(request.body(300).size(), 300u);
    EXPECT_EQ(codeOf([&] { request.body(299); }), ErrorCode::tooLarge);
    request.contentLength = 1000;  // announced: not a byte is read
    request.stream = [](const HttpRequest::Consumer&) { FAIL(); };
    EXPECT_EQ(codeOf([&] { request.body(999); }), ErrorCode::tooLarge);
}

TEST(Problem, KeepsEveryFaultAndSaysWhetherToRetry) {
    const auto response = problemResponse(Error(ErrorCode::outOfSpace, "full", {{"/a", "b"}}));
    EXPECT_EQ(response.status, 507);
    EXPECT_EQ(response.type, "application/problem+json");
    const auto& text = std::get<std::string>(response.body);
    EXPECT_NE(text.find(R"("errors":[{"message":"b","pointer":"/a"}])"), std::string::npos);
    EXPECT_NE(text.find(R"("retryable":true)"), std::string::npos);
}

}  // namespace
}  // namespace tilefarm
