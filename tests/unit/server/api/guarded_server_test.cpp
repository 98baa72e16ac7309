#include "tests/unit/server/api/api_fixture.h"
#include "tests/unit/server/api/raw_connection.h"

namespace tilefarm {
namespace {

using std::chrono::milliseconds;

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::string request(const std::string& line, const std::string& headers = "") {
    return line + " HTTP/1.1\r\nHost: x\r\n" + headers + "\r\n";
}

// A second server over the same farm, with bounds that a test reaches.
class GuardedApi : public ApiTest {
protected:
    static HttpConfig with(const HttpLimits& limits) {
        HttpConfig config;
        config.limits = limits;
        return config;
    }
};

TEST_F(GuardedApi, RefusesAHeadThatIsTooLarge) {
    RawConnection one(server.port()), many(server.port());
    one.send("GET /healthz HTTP/1.1\r\nX: " + std::string(70 << 10, 'x'));
    EXPECT_TRUE(has(one.receive(), " 431 "));
    std::string headers;
    for (int i = 0; i < 200; ++i) headers += "X: 1\r\n";
    many.send(request("GET /healthz", headers));
    EXPECT_TRUE(has(many.receive(), " 400 "));
}

TEST_F(GuardedApi, EndsAConnectionWhoseHeadTakesTooLong) {
    HttpLimits limits;
    limits.headTime = milliseconds(100);
    HttpServer tight(services, with(limits));
    RawConnection slow(tight.port()), silent(tight.port());
    slow.send("GET /healthz HT");
    EXPECT_TRUE(has(slow.receive(), " 408 "));
    EXPECT_EQ(silent.receive(), "");
}

TEST_F(GuardedApi, EndsAConnectionWhoseBodyIsSlowerThanTheLeastRate) {
    HttpLimits limits;
    limits.body.grace = milliseconds(100);
    HttpServer tight(services, with(limits));
    RawConnection slow(tight.port());
    const std::string line = "PUT /v1/blobs/" + sha256Hex(std::string_view("bytes"));
    slow.send(request(line, "Content-Length: 5\r\n") + "by");
    const std::string answer = slow.receive();
    EXPECT_TRUE(has(answer, " 408 ") && has(answer, "\"retryable\":true")) << answer;
    EXPECT_FALSE(has(answer, "(nothing more)"));
}

TEST_F(GuardedApi, RefusesWhatTwoReadersCouldTakeForDifferentRequests) {
    for (const char* headers :
         {"Content-Length: 5\r\nContent-Length: 6\r\n", "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n",
          "Transfer-Encoding: gzip\r\n", "Content-Length: +5\r\n", "Content-Length : 5\r\n",
          "X: 1\r\n folded\r\n"}) {
        RawConnection connection(server.port());
        connection.send(request("POST /v1/blobs/missing", headers));
        const std::string answer = connection.receive();
        EXPECT_TRUE(has(answer, " 400 ")) << headers << answer;
        EXPECT_FALSE(has(answer, "(nothing more)")) << "the connection ends";
    }
    RawConnection get(server.port());
    get.send(request("GET /healthz", "Content-Length: 20\r\n") + request("GET /v1/jobs"));
    EXPECT_FALSE(has(get.receive(), " 200 "));
}

TEST_F(GuardedApi, AnswersRequestsThatComeInOnePiece) {
    RawConnection connection(server.port());
    connection.send(request("GET /healthz") + request("GET /v1/jobs", "Connection: close\r\n"));
    const std::string answers = connection.receive();
    EXPECT_TRUE(has(answers, "\"status\":\"ok\"") && has(answers, "\"jobs\":[]")) << answers;
}

TEST_F(GuardedApi, EndsAConnectionAfterABodyThatIsTooLarge) {
    RawConnection connection(server.port());
    const std::string line = "PUT /v1/blobs/" + sha256Hex(std::string_view("x"));
    connection.send(request(line, "Content-Length: 1000000000\r\n"));
    const std::string answer = connection.receive();
    EXPECT_TRUE(has(answer, " 413 ")) << answer;
    EXPECT_FALSE(has(answer, "(nothing more)"));
}

TEST_F(GuardedApi, AnswersLeasesAndHealthWhereOthersHaveToComeAgain) {
    HttpLimits limits;
    limits.connections = 2;
    HttpServer tight(services, with(limits));
    std::vector<RawConnection> slow;
    for (int i = 0; i < 2; ++i) {
        slow.emplace_back(tight.port());
        slow.back().send("GET /v1/jobs HTT");
    }
    const auto ask = [&](const std::string& text) {
        RawConnection connection(tight.port());
        connection.send(text);
        return connection.receive();
    };
    const std::string body = toJson(hello("w")).dump();
    const std::string refused = ask(request("GET /v1/jobs"));
    EXPECT_TRUE(has(refused, " 503 ") && has(refused, "Retry-After: 1")) << refused;
    EXPECT_TRUE(has(ask(request("GET /healthz")), " 200 "));
    const std::string length = "Content-Length: " + std::to_string(body.size()) + "\r\n";
    EXPECT_TRUE(has(ask(request("POST /v1/leases", length) + body), " 204 "));
}

TEST_F(GuardedApi, RefusesEventStreamsBeyondSoMany) {
    HttpLimits limits;
    limits.eventStreams = 1;
    HttpServer tight(services, with(limits));
    RawConnection first(tight.port()), second(tight.port());
    first.send(request("GET /v1/events"));
    EXPECT_TRUE(has(first.receive(": tilefarm"), " 200 "));
    second.send(request("GET /v1/events"));
    EXPECT_TRUE(has(second.receive(), " 503 "));
    events.close();
}

// Of the gigabyte not a byte is sent: who reads on would wait for it.
TEST_F(TokenTest, RefusesWhoeverHasNoTokenBeforeItReadsABody) {
    RawConnection connection(server.port());
    connection.send(request("PUT /v1/blobs/" + std::string(64, 'a'), "Content-Length: 1000000000\r\n"));
    const std::string answer = connection.receive();
    EXPECT_TRUE(has(answer, " 401 ") && has(answer, "WWW-Authenticate: Bearer")) << answer;
    EXPECT_FALSE(has(answer, "(nothing more)")) << "the connection ends";
}

}  // namespace
}  // namespace tilefarm
