#include <set>

#include "server/api/openapi.h"
#include "server/api/routes.h"
#include "tests/unit/server/api/api_fixture.h"

namespace tilefarm {
namespace {

TEST_F(ApiTest, DescribesExactlyItsRoutes) {
    std::set<std::string> served, described;
    for (const Route& route : routes())
        served.insert(std::string(route.method) + " " + std::string(route.pattern));
    const auto document = nlohmann::json::parse(openApiJson());
    for (const auto& [path, operations] : document["paths"].items()) {
        for (const auto& [method, operation] : operations.items()) {
            std::string upper = method;
            for (char& c : upper) c = static_cast<char>(std::toupper(c));
            described.insert(upper + " " + path);
        }
    }
    EXPECT_EQ(served, described);
}

TEST_F(ApiTest, DescribesEachOperationInItsOwnFields) {
    const auto document = nlohmann::json::parse(openApiJson());
    for (const auto& [path, operations] : document["paths"].items()) {
        for (const auto& [method, operation] : operations.items()) {
            SCOPED_TRACE(method + " " + path);
            EXPECT_TRUE(operation.at("summary").is_string());
            EXPECT_FALSE(operation.at("responses").empty());
            ASSERT_FALSE(operation.at("tags").empty());
            for (const auto& tag : operation["tags"]) EXPECT_TRUE(tag.is_string());
            EXPECT_TRUE(operation.value("description", nlohmann::json("")).is_string());
            EXPECT_TRUE(!operation.contains("requestBody") || operation["requestBody"].contains("content"));
            for (const auto& parameter : operation.value("parameters", nlohmann::json::array())) {
                EXPECT_TRUE(parameter.contains("$ref") || parameter.contains("schema"));
                EXPECT_TRUE(parameter.value("in", "") != "path" || parameter.value("required", false));
            }
        }
    }
}

TEST_F(ApiTest, ResolvesEveryReferenceOfItsDescription) {
    const auto document = parsed(get("/v1/openapi.json"));
    EXPECT_EQ(document["openapi"], "3.1.0");
    EXPECT_TRUE(document["components"]["schemas"]["Job"].contains("properties"));
    const std::string text = document["paths"].dump();
    for (size_t at = 0; (at = text.find("#/components/", at)) != std::string::npos; ++at) {
        const std::string pointer = text.substr(at + 1, text.find('"', at) - at - 1);
        EXPECT_TRUE(document.contains(nlohmann::json::json_pointer(pointer))) << pointer;
    }
}

std::set<std::string> parametersOf(const std::string& path) {
    std::set<std::string> found;
    for (size_t at = 0; (at = path.find('{', at)) != std::string::npos; ++at)
        found.insert(path.substr(at + 1, path.find('}', at) - at - 1));
    return found;
}

// Clients call an operation by its name. What is valid without is left to the validator: e2e/openapi_test.py.
TEST_F(ApiTest, NamesEveryOperationAndTheParametersOfItsPath) {
    std::set<std::string> names;
    const json document = parsed(get("/v1/openapi.json"));
    for (const auto& [path, operations] : document["paths"].items()) {
        for (const auto& [method, operation] : operations.items()) {
            const std::string place = method + " " + path, name = operation.value("operationId", "");
            EXPECT_TRUE(!name.empty() && names.insert(name).second) << place;
            EXPECT_FALSE(operation.value("summary", "").empty()) << place;
            std::set<std::string> inPath;
            for (const json& parameter : operation.value("parameters", json::array())) {
                EXPECT_FALSE(parameter.value("description", "").empty()) << place;
                EXPECT_TRUE(parameter["schema"].contains("type")) << place;
                if (parameter["in"] == "path") inPath.insert(parameter["name"]);
            }
            EXPECT_EQ(inPath, parametersOf(path)) << place;
        }
    }
}

TEST_F(ApiTest, SaysThatItIsWell) {
    const auto health = get("/healthz");
    ASSERT_TRUE(health);
    EXPECT_EQ(health->status, 200);
    EXPECT_EQ(parsed(health)["version"], TILEFARM_VERSION);
}

TEST_F(ApiTest, TellsEveryFaultAsAProblem) {
    const auto missing = get("/v1/nothing/here");
    EXPECT_EQ(missing->status, 404);
    EXPECT_EQ(missing->get_header_value("Content-Type"), "application/problem+json");
    EXPECT_EQ(parsed(missing)["status"], 404);
    EXPECT_EQ(parsed(missing)["retryable"], false);
    const auto wrongMethod = client.Delete("/v1/jobs");
    EXPECT_EQ(wrongMethod->status, 405);
    EXPECT_EQ(wrongMethod->get_header_value("Allow"), "GET, POST");
    EXPECT_EQ(get("/v1/jobs?limit=0")->status, 400);
    EXPECT_EQ(get("/v1/jobs?cursor=x")->status, 400);
    EXPECT_EQ(get("/v1/jobs?state=sleeping")->status, 400);
}

TEST_F(ApiTest, ReadsTheNextRequestRightAfterABodyItRefused) {
    client.set_keep_alive(true);
    const std::string large(3 << 20, 'x');
    EXPECT_EQ(client.Put(("/v1/blobs/" + sha256Hex(large)).c_str(), large, "text/plain")->status, 413);
    EXPECT_EQ(client.Post("/v1/nothing", large, "text/plain")->status, 404);
    EXPECT_EQ(client.Post("/v1/jobs", "--x\r\n", "multipart/form-data; boundary=x")->status, 400);
    EXPECT_EQ(get("/healthz")->status, 200);
}

// Of lengths that no matching could be hurt by.
TEST_F(ApiTest, RefusesAPathAboveAKilobyteBeforeAnyRouteIsMatched) {
    const auto pathOf = [](size_t bytes) { return "/v1/" + std::string(bytes - 4, 'a'); };
    EXPECT_EQ(get(pathOf(1024))->status, 404);  // looked for and not found
    for (const size_t bytes : {1025, 2000}) {
        const auto refused = get(pathOf(bytes));
        ASSERT_TRUE(refused);
        EXPECT_EQ(refused->status, 414);
        EXPECT_EQ(refused->get_header_value("Content-Type"), "application/problem+json");
        EXPECT_EQ(parsed(refused)["status"], 414);
        EXPECT_NE(parsed(refused)["detail"].get<std::string>().find("1024"), std::string::npos);
    }
    EXPECT_EQ(client.Options(pathOf(1025).c_str())->status, 414);
    EXPECT_EQ(client.Delete(pathOf(1025).c_str())->status, 414);
    EXPECT_EQ(client.Head(pathOf(1025).c_str())->status, 414);
}

TEST_F(ApiTest, MeasuresThePathAsItIsSentAndWithoutItsQuery) {
    std::string encoded = "/v1/";
    while (encoded.size() <= 1024) encoded += "%61";  // 'a', decoded within the limit
    EXPECT_EQ(get(encoded)->status, 414);
    EXPECT_EQ(get("/v1/jobs?limit=1&other=" + std::string(1500, 'a'))->status, 200);
}

TEST_F(ApiTest, ReadsTheNextRequestRightAfterAPathItRefused) {
    client.set_keep_alive(true);
    const std::string path = "/v1/jobs/" + std::string(1100, 'a');
    EXPECT_EQ(client.Post(path.c_str(), std::string(100'000, 'x'), "text/plain")->status, 414);
    EXPECT_EQ(client.Post(path.c_str(), "--x\r\n", "multipart/form-data; boundary=x")->status, 414);
    EXPECT_EQ(get("/healthz")->status, 200);
}

TEST_F(ApiTest, AnswersAHeaderRangeOfAFewKilobytes) {
    const std::string path = "/v1/blobs/" + spec("bytes").scene.files.at("a.glb");
    EXPECT_EQ(get(path, {{"Range", "bytes=" + std::string(4000, '0') + "1-3"}})->body, "yte");
    std::string many = "bytes=0-0";
    while (many.size() < 4000) many += ",1-1";
    EXPECT_EQ(get(path, {{"Range", many}})->body, "bytes");  // a list is passed over
}

TEST_F(ApiTest, CountsWhatItDoes) {
    submit();
    askForWork();
    const std::string text = get("/metrics")->body;
    EXPECT_NE(text.find("tilefarm_leases_total 1"), std::string::npos);
    EXPECT_NE(text.find("tilefarm_passes{state=\"leased\"} 24"), std::string::npos);
    EXPECT_NE(text.find("tilefarm_jobs{state=\"running\"} 1"), std::string::npos);
}

TEST_F(ApiTest, ShowsAPageThatAsksNothingOfOtherHosts) {
    const auto page = get("/");
    EXPECT_EQ(page->status, 200);
    EXPECT_EQ(page->get_header_value("Content-Type"), "text/html; charset=utf-8");
    EXPECT_EQ(page->body.find("https://"), std::string::npos);
    EXPECT_NE(page->get_header_value("Content-Security-Policy").find("default-src 'none'"),
              std::string::npos);
}

TEST_F(ApiTest, RefusesAPortThatIsTaken) {
    try {
        HttpServer second(services, {.host = "127.0.0.1", .port = server.port()});
        FAIL() << "two servers on one port";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(std::to_string(server.port())), std::string::npos);
    }
}

TEST_F(ApiTest, ServesManyWatchersAndAWorkerAtOnce) {
    std::vector<std::thread> watchers;
    std::atomic<int> connected = 0;
    for (int i = 0; i < 40; ++i) {
        watchers.emplace_back([&] {
            httplib::Client watcher("127.0.0.1", server.port());
            watcher.set_read_timeout(30);
            bool first = true;
            watcher.Get("/v1/events", [&](const char*, size_t) {
                if (std::exchange(first, false)) ++connected;
                return true;
            });
        });
    }
    while (connected < 40) std::this_thread::yield();
    EXPECT_EQ(get("/healthz")->status, 200);
    events.close();
    for (std::thread& watcher : watchers) watcher.join();
}

TEST_F(TokenTest, LetsNobodyInWithoutTheToken) {
    EXPECT_EQ(get("/v1/jobs")->status, 401);
    EXPECT_EQ(get("/v1/jobs")->get_header_value("WWW-Authenticate"), "Bearer");
    EXPECT_EQ(get("/v1/jobs", {{"Authorization", "Bearer wrong!"}})->status, 401);
    EXPECT_EQ(get("/v1/jobs", {{"Authorization", "Bearer secret2"}})->status, 401);
    EXPECT_EQ(get("/v1/jobs", {{"Authorization", "Bearer secret"}})->status, 200);
    EXPECT_EQ(get("/metrics")->status, 401);
    EXPECT_EQ(get("/v1/unknown")->status, 401);
    EXPECT_EQ(get("/healthz")->status, 200);
    EXPECT_EQ(get("/")->status, 200);
}

class LowDiskTest : public ApiTest {
protected:
    static ApiConfig withFloor() {
        ApiConfig config = defaults();
        config.leastFreeBytes = 1ull << 60;
        return config;
    }
    LowDiskTest() : ApiTest(withFloor()) {}
};

TEST_F(LowDiskTest, RefusesUploadsAndJobsButShowsWhatItHas) {
    const auto blob =
        client.Put(("/v1/blobs/" + sha256Hex(std::string_view("x"))).c_str(), "x", "text/plain");
    EXPECT_EQ(blob->status, 507);
    EXPECT_EQ(parsed(blob)["retryable"], true);
    EXPECT_FALSE(blob->get_header_value("Retry-After").empty());
    EXPECT_EQ(post("/v1/jobs", toJson(spec()))->status, 507);
    EXPECT_EQ(get("/v1/jobs")->status, 200);
}

}  // namespace
}  // namespace tilefarm
