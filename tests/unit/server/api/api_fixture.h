#pragma once

#include <gtest/gtest.h>
#include <httplib.h>

#include <nlohmann/json.hpp>

#include "server/api/http_server.h"
#include "server/api/services.h"
#include "shared/digest/digest.h"
#include "shared/image/exr.h"
#include "shared/job/wire.h"
#include "tests/support/memory_blob_store.h"
#include "tests/unit/server/support/test_farm.h"

namespace tilefarm {

/// A server in this process on a free port, on a fake clock. The client goes before the server does.
class ApiTest : public testing::Test {
protected:
    using json = nlohmann::json;

    explicit ApiTest(ApiConfig config = defaults())
        : services{config,       farm.clock,   *farm.store, blobs,   *farm.scheduler,
                   *farm.merger, *farm.images, events,      metrics, studies} {}
    static ApiConfig defaults() {
        ApiConfig config;
        config.folder = "/";
        config.leastFreeBytes = 0;
        config.mostBlobBytes = 1 << 20;
        return config;
    }

    JobSpec spec(const std::string& sceneBytes = "scene") {
        const auto writer = blobs.create(sha256Hex(sceneBytes));
        writer->write(std::as_bytes(std::span(sceneBytes)));
        writer->commit();
        JobSpec spec = smallJob();
        spec.scene.files = {{"a.glb", sha256Hex(sceneBytes)}};
        return spec;
    }
    httplib::Result get(const std::string& path, const httplib::Headers& headers = {}) {
        return client.Get(path.c_str(), headers);
    }
    httplib::Result post(const std::string& path, const json& body, const httplib::Headers& headers = {}) {
        return client.Post(path.c_str(), headers, body.dump(), "application/json");
    }
    json submit() { return json::parse(post("/v1/jobs", toJson(spec()))->body); }
    static json parsed(const httplib::Result& result) { return json::parse(result->body); }
    httplib::Result askForWork() { return post("/v1/leases", toJson(hello("w"))); }
    static std::string contentDigest(const std::string& body);
    /// Uploads what a renderer would leave for the lease.
    httplib::Result upload(const Lease& lease, const std::string& extra = "");
    static std::string encoded(const Lease& lease);

    TestFarm farm;
    MemoryBlobStore blobs;
    EventBus events;
    Metrics metrics;
    StudyRunner studies{*farm.store, *farm.scheduler, *farm.images, farm.clock};
    Services services;
    HttpServer server{services, {.host = "127.0.0.1", .port = 0, .keepAliveSeconds = 1}};
    httplib::Client client{"127.0.0.1", server.port()};
};

/// The same with a token, which is "secret".
class TokenTest : public ApiTest {
protected:
    TokenTest() : ApiTest(withToken()) {}
    static ApiConfig withToken() {
        ApiConfig config = defaults();
        config.token = "secret";
        return config;
    }
};

}  // namespace tilefarm
