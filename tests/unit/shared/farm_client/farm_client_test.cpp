#include "shared/farm_client/farm_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "shared/digest/digest.h"
#include "shared/file/durable_file.h"
#include "shared/job/wire.h"
#include "tests/support/expect_error.h"
#include "tests/support/fake_farm.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

const WorkerHello kHello{"w-1", "h", "llvmpipe", "Mesa", "0.1.0"};

// Several blocks of the client's streaming, and not a whole number of them.
std::string bigBlob() {
    std::mt19937 random(5);
    std::string bytes(3'500'001, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    return bytes;
}

JobSpec specOf(const std::string& digest) {
    JobSpec spec;
    spec.scene = {"a.glb", {{"a.glb", digest}}, ""};
    return spec;
}

struct FarmClientTest : testing::Test {
    FakeFarm farm;
    FarmClient client{farm.url()};
    TemporaryFolder folder;

    std::string store(const std::string& bytes) {
        writeDurably(folder / "blob", bytes);
        const std::string digest = sha256Hex(std::string_view(bytes));
        client.putBlob(digest, folder / "blob");
        return digest;
    }
};

TEST_F(FarmClientTest, StreamsBlobsUpAndDownUnchanged) {
    for (const std::string& bytes : {bigBlob(), std::string("x"), std::string()}) {
        const std::string digest = store(bytes);
        EXPECT_EQ(farm.blobs().at(digest), bytes);
        client.getBlob(digest, folder / "back");
        EXPECT_EQ(sha256OfFile(folder / "back"), digest);
    }
}

TEST_F(FarmClientTest, AsksWhichBlobsAreMissing) {
    const std::string there = store("there"), absent(64, 'a');
    EXPECT_THAT(client.missingBlobs({there, absent}), ElementsAre(absent));
    EXPECT_TRUE(client.missingBlobs({}).empty());
}

TEST_F(FarmClientTest, LeavesNoFileWhereABlobCannotBeHad) {
    const Error error = errorOf([&] { client.getBlob(std::string(64, 'a'), folder / "back"); });
    EXPECT_EQ(error.code, ErrorCode::notFound);
    EXPECT_THAT(error.what(), HasSubstr("no blob aaaa"));
    EXPECT_FALSE(fs::exists(folder / "back"));
    EXPECT_EQ(codeOf([&] { client.getBlob(store("x"), folder / "no/such/folder"); }), ErrorCode::notFound);
}

TEST_F(FarmClientTest, NamesTheFileItCannotSend) {
    EXPECT_THAT(errorOf([&] { client.putBlob(std::string(64, 'a'), folder / "absent"); }).what(),
                HasSubstr("absent"));
}

TEST_F(FarmClientTest, CarriesARefusalWithItsMessage) {
    writeDurably(folder / "blob", "other bytes");
    const Error error = errorOf([&] { client.putBlob(std::string(64, 'a'), folder / "blob"); });
    EXPECT_EQ(error.code, ErrorCode::unprocessable);
    EXPECT_THAT(error.what(), StartsWith("the bytes are not those of"));
}

TEST_F(FarmClientTest, SubmitsAndFollowsAJob) {
    const json view = client.submit(specOf(store("scene")), "key-1");
    EXPECT_EQ(view["id"], "1");
    EXPECT_EQ(farm.seen().back().idempotencyKey, "key-1");
    EXPECT_EQ(client.job("1")["state"], "running");
    EXPECT_EQ(client.jobs("state=running&limit=5")["jobs"].size(), 1u);
    EXPECT_EQ(farm.seen().back().path, "/v1/jobs?state=running&limit=5");
    EXPECT_EQ(client.pause("1")["state"], "paused");
    EXPECT_EQ(client.resume("1")["state"], "running");
    EXPECT_EQ(client.cancel("1")["state"], "canceled");
    EXPECT_EQ(client.workers()["workers"][0]["worker"], "w1");
    EXPECT_EQ(client.validate(specOf(store("scene")))["valid"], true);
}

TEST_F(FarmClientTest, CarriesEveryFaultOfARefusedJob) {
    JobSpec spec = specOf(store("scene"));
    spec.image.width = 40000;
    spec.stop.samples = (1u << 24) + 1;
    const Error error = errorOf([&] { client.submit(spec); });
    EXPECT_EQ(error.code, ErrorCode::invalidArgument);
    EXPECT_EQ(error.faults.size(), 2u);
    EXPECT_EQ(error.faults.at(0).pointer, "/image/width");
    EXPECT_EQ(errorOf([&] { client.submit(specOf(std::string(64, 'b'))); }).faults.at(0).pointer,
              "/scene/files/a.glb");
}

TEST_F(FarmClientTest, EncodesWhatGoesIntoAPath) {
    EXPECT_EQ(codeOf([&] { client.job("../workers"); }), ErrorCode::notFound);
    EXPECT_EQ(codeOf([&] { client.job("1?x=ü 7"); }), ErrorCode::notFound);
    ASSERT_EQ(farm.seen().size(), 1u);  // the first matched no route
    EXPECT_EQ(farm.seen().back().path, "/v1/jobs/1%3Fx%3D%C3%BC%207");
}

TEST_F(FarmClientTest, DownloadsImages) {
    farm.setImage(bigBlob());
    client.download("/v1/jobs/1/frames/-3/image.exr", folder / "a.exr");
    EXPECT_EQ(sha256OfFile(folder / "a.exr"), sha256Hex(std::string_view(bigBlob())));
}

TEST_F(FarmClientTest, TakesLeasesAndTheWaitWhereThereIsNone) {
    EXPECT_EQ(std::get<NoWork>(client.lease(kHello, 5)).retryAfterMs, 1500u);
    EXPECT_EQ(json::parse(farm.seen().back().body)["wantSeconds"], 5.0);

    Lease offered;
    offered.id = "l-1", offered.epoch = 3, offered.jobId = "1";
    offered.spec = specOf(std::string(64, 'a'));
    offered.spec.image = {.width = 64, .height = 32};
    offered.spec.stop.samples = 64;
    offered.passes = {{0, {0, 1}}};
    farm.offerLease(toJson(offered).dump());
    EXPECT_EQ(std::get<Lease>(client.lease(kHello, 5)), offered);
}

TEST_F(FarmClientTest, FallsBackToRetryAfterInSeconds) {
    farm.answerAll(204, "", "text/plain", {{"Retry-After", "7"}});
    EXPECT_EQ(std::get<NoWork>(client.lease(kHello, 5)).retryAfterMs, 7000u);
    farm.answerAll(204, "", "text/plain", {{"Retry-After", "Wed, 21 Oct 2015 07:28:00 GMT"}});
    EXPECT_EQ(std::get<NoWork>(client.lease(kHello, 5)).retryAfterMs, NoWork{}.retryAfterMs);
}

TEST_F(FarmClientTest, UploadsAResultWithItsDigest) {
    const std::string bytes = bigBlob();
    const ResultUpload result{"l-1", 9, std::as_bytes(std::span(bytes)), sha256Hex(std::string_view(bytes)),
                              1.25};
    EXPECT_EQ(client.upload(result), (ResultReceipt{2, 1}));
    const FakeFarm::Seen request = farm.seen().back();
    EXPECT_EQ(request.path, "/v1/leases/l-1/result?epoch=9&deviceSeconds=1.25");
    EXPECT_EQ(request.body, bytes);
    EXPECT_THAT(request.contentDigest, StartsWith("sha-256=:"));
}

TEST_F(FarmClientTest, SpeaksOfItsLeases) {
    client.renew("l-1", 4);
    client.handBack("l-1", 4);
    client.reportFailure("l-1", 4, "device lost");
    client.reportScene("l-1", 4, {{"warnings", json::array()}});
    std::vector<std::string> paths;
    for (const auto& request : farm.seen()) {
        EXPECT_EQ(json::parse(request.body)["epoch"], 4);
        paths.push_back(request.path);
    }
    EXPECT_THAT(paths, ElementsAre("/v1/leases/l-1/renew", "/v1/leases/l-1/return", "/v1/leases/l-1/failure",
                                   "/v1/leases/l-1/report"));
    EXPECT_EQ(json::parse(farm.seen()[2].body)["message"], "device lost");
}

TEST_F(FarmClientTest, TurnsEveryStatusIntoItsCode) {
    for (const auto& [status, code] : {std::pair{401, ErrorCode::unauthorized},
                                       {409, ErrorCode::conflict},
                                       {410, ErrorCode::gone},
                                       {426, ErrorCode::versionRefused},
                                       {429, ErrorCode::tooMany},
                                       {500, ErrorCode::internal},
                                       {503, ErrorCode::unavailable},
                                       {507, ErrorCode::outOfSpace}}) {
        farm.answerAll(status, R"({"detail":"said so"})");
        const Error error = errorOf([&] { client.renew("l-1", 1); });
        EXPECT_EQ(error.code, code) << status;
        EXPECT_STREQ(error.what(), "said so");
        EXPECT_EQ(codeOf([&] { client.download("/v1/x", folder / "x"); }), code);
    }
    EXPECT_FALSE(fs::exists(folder / "x"));
}

TEST_F(FarmClientTest, CallsAnAnswerThatIsNotAsAgreedAFaultOfTheServer) {
    farm.answerAll(200, "<html>", "text/html");
    EXPECT_EQ(codeOf([&] { client.job("1"); }), ErrorCode::internal);
    farm.answerAll(201, R"({"id": 7})", "application/json");
    EXPECT_EQ(codeOf([&] { client.lease(kHello, 5); }), ErrorCode::internal);
    farm.answerAll(200, R"({"missing": 7})", "application/json");
    EXPECT_EQ(codeOf([&] { client.missingBlobs({}); }), ErrorCode::internal);
}

TEST_F(FarmClientTest, SendsItsTokenOnlyWhenItHasOne) {
    client.workers();
    EXPECT_EQ(farm.seen().back().authorization, "");
    FarmClient(farm.url(), "s3cret").workers();
    EXPECT_EQ(farm.seen().back().authorization, "Bearer s3cret");
}

TEST_F(FarmClientTest, KeepsItsConnection) {
    client.workers();
    client.workers();
    client.workers();
    const auto seen = farm.seen();
    EXPECT_EQ(seen[0].port, seen[1].port);
    EXPECT_EQ(seen[1].port, seen[2].port);
}

TEST(FarmClient, NamesAServerItCannotReach) {
    std::string url;
    {
        const FakeFarm gone;
        url = gone.url();
    }
    FarmClient client(url);
    const Error error = errorOf([&] { client.workers(); });
    EXPECT_EQ(error.code, ErrorCode::unavailable);
    EXPECT_THAT(error.what(), HasSubstr(url));
}

TEST(FarmClient, TakesUrlsOnly) {
    for (const char* url : {"", "localhost:80", "ftp://h", "http://", "http://h:port", "http://h/path",
                            "http://h:1 x", "http://u@h"})
        EXPECT_EQ(codeOf([&] { FarmClient client(url); }), ErrorCode::invalidArgument) << url;
    for (const char* url : {"http://h", "http://h:80/", "https://farm.example.org:8443", "http://[::1]:80"})
        EXPECT_NO_THROW(FarmClient client(url)) << url;
}

}  // namespace
}  // namespace tilefarm
