#include "tests/unit/server/api/api_fixture.h"
#include "tests/unit/server/api/raw_connection.h"

namespace tilefarm {
namespace {

TEST_F(ApiTest, TellsAnIdleWorkerWhenToAskAgain) {
    const auto answer = askForWork();
    EXPECT_EQ(answer->status, 204);
    EXPECT_EQ(answer->get_header_value("Retry-After"), "1");
    EXPECT_EQ(answer->get_header_value("Tilefarm-Retry-After-Ms"), "500");
}

TEST_F(ApiTest, RefusesAWorkerOfAnotherVersion) {
    WorkerHello old = hello("w");
    old.version = "0.0.1";
    const auto answer = post("/v1/leases", toJson(old));
    EXPECT_EQ(answer->status, 426);
    EXPECT_NE(answer->body.find(TILEFARM_VERSION), std::string::npos);
    EXPECT_EQ(post("/v1/leases", json::array())->status, 400);
    EXPECT_EQ(post("/v1/leases", json::object())->status, 400);
}

TEST_F(ApiTest, SaysWhyAJobIsSetAsideAndResumesIt) {
    const std::string path = "/v1/jobs/" + submit()["id"].get<std::string>();
    EXPECT_EQ(parsed(get(path))["setAside"], nullptr);
    for (int process = 0; process < 4; ++process) {  // each but the first follows one that was killed
        WorkerHello worker = hello("w" + std::to_string(process));
        worker.session = std::to_string(process);
        if (process > 0) worker.ended = {std::to_string(process - 1)};
        EXPECT_EQ(post("/v1/leases", toJson(worker))->status, process < 3 ? 201 : 204);
    }
    const json view = parsed(get(path));
    EXPECT_EQ(view["state"], "paused");
    EXPECT_NE(view["setAside"].get<std::string>().find("3 workers were killed"), std::string::npos);
    EXPECT_EQ(view["faults"], json::array({view["setAside"]}));
    const json resumed = parsed(client.Post((path + "/resume").c_str()));
    EXPECT_EQ(resumed["state"], "running");
    EXPECT_EQ(resumed["setAside"], nullptr);
}

TEST_F(ApiTest, TakesAJobFromSubmissionToItsImage) {
    const std::string id = submit()["id"];
    const auto answer = askForWork();
    ASSERT_EQ(answer->status, 201);
    const Lease lease = leaseFromJson(parsed(answer));
    EXPECT_EQ(lease.jobId, id);
    EXPECT_EQ(get("/v1/jobs/" + id + "/frames/0/image.exr")->get_header_value("Tilefarm-State"), "partial");

    const auto receipt = upload(lease);
    ASSERT_EQ(receipt->status, 200) << receipt->body;
    EXPECT_EQ(receiptFromJson(parsed(receipt)), (ResultReceipt{24, 0}));
    EXPECT_EQ(receiptFromJson(parsed(upload(lease))), (ResultReceipt{0, 24}));
    farm.images->finishFrames();

    const json view = parsed(get("/v1/jobs/" + id));
    EXPECT_EQ(view["state"], "completed");
    EXPECT_EQ(view["progress"]["fraction"], 1.0);
    EXPECT_EQ(view["samplesMerged"], 8);
    EXPECT_EQ(view["deviceSeconds"], 1.5);
    EXPECT_EQ(view["errorCurve"].size(), 4u);
    EXPECT_EQ(view["errorCurve"][0]["relativeErrorInterval"], nullptr) << "at one sample";
    EXPECT_EQ(view["errorCurve"][3]["relativeErrorInterval"], view["relativeErrorInterval"]);
    EXPECT_LT(view["relativeErrorInterval"][0], view["relativeError"]);
    EXPECT_GT(view["relativeErrorInterval"][1], view["relativeError"]);
    EXPECT_FALSE(view["errorTail"]["pixels"].empty());
    const auto image = get("/v1/jobs/" + id + "/frames/0/image.exr");
    EXPECT_EQ(image->get_header_value("Tilefarm-State"), "complete");
    EXPECT_EQ(image->get_header_value("ETag"), '"' + sha256Hex(image->body) + '"');
    EXPECT_EQ(get("/v1/jobs/" + id + "/frames/0/image.png")->get_header_value("Content-Type"), "image/png");
    const json report = parsed(get("/v1/jobs/" + id + "/report"));
    EXPECT_EQ(report["workers"][0]["deviceSeconds"], 1.5);
    EXPECT_EQ(report["devices"][0]["device"], "device");
    EXPECT_EQ(report["frames"][0]["errorCurve"].size(), 4u);
    EXPECT_EQ(report["frames"][0]["errorTail"], view["errorTail"]);
    EXPECT_EQ(parsed(get("/v1/workers"))["workers"][0]["state"], "online");
}

TEST_F(ApiTest, AnswersConditionsAndRangesOnImages) {
    const std::string path = "/v1/jobs/" + submit()["id"].get<std::string>() + "/frames/0/image.exr";
    EXPECT_EQ(get(path)->status, 404);  // not begun
    upload(leaseFromJson(parsed(askForWork())));
    farm.images->finishFrames();
    const auto whole = get(path);
    const std::string etag = whole->get_header_value("ETag");
    EXPECT_EQ(get(path, {{"If-None-Match", etag}})->status, 304);
    EXPECT_EQ(get(path, {{"If-None-Match", "\"other\""}})->status, 200);
    const auto part = get(path, {{"Range", "bytes=4-7"}});
    EXPECT_EQ(part->status, 206);
    EXPECT_EQ(part->body, whole->body.substr(4, 4));
    EXPECT_EQ(part->get_header_value("Content-Range"), "bytes 4-7/" + std::to_string(whole->body.size()));
    EXPECT_EQ(get(path, {{"Range", "bytes=-5"}})->body, whole->body.substr(whole->body.size() - 5));
    EXPECT_EQ(get(path, {{"Range", "bytes=999999999-"}})->status, 416);
    EXPECT_EQ(get(path, {{"Range", "bytes=0-3"}, {"If-Range", "\"other\""}})->body, whole->body);
    const auto head = client.Head(path.c_str());
    EXPECT_EQ(head->get_header_value("Content-Length"), std::to_string(whole->body.size()));
    EXPECT_TRUE(head->body.empty());
}

TEST_F(ApiTest, RefusesPictureParametersThatMakeNoSense) {
    const std::string path = "/v1/jobs/" + submit()["id"].get<std::string>() + "/frames/0/";
    upload(leaseFromJson(parsed(askForWork())));
    EXPECT_EQ(get(path + "image.png?tone=sepia")->status, 400);
    EXPECT_EQ(get(path + "image.png?exposure=nan")->status, 400);
    EXPECT_EQ(get(path + "preview.png?width=1")->status, 400);
    EXPECT_EQ(get(path + "image.png?denoised=yes")->status, 400);
    EXPECT_EQ(get(path + "image.png?denoised=0")->status, 200);
    EXPECT_EQ(get(path + "image.png?denoised=1")->status, 409);  // not asked for by the job
    EXPECT_EQ(get(path + "preview.png?width=20&tone=aces&exposure=-1.5")->status, 200);
    EXPECT_EQ(get("/v1/jobs/none/frames/0/image.png")->status, 404);
    EXPECT_EQ(get(path.substr(0, path.size() - 2) + "x/image.png")->status, 404);
}

TEST_F(ApiTest, RefusesResultsThatAreDamaged) {
    submit();
    const Lease lease = leaseFromJson(parsed(askForWork()));
    EXPECT_EQ(upload(lease, "tail")->status, 422);  // not the bytes of the digest
    const std::string path = "/v1/leases/" + lease.id + "/result?epoch=" + std::to_string(lease.epoch);
    const std::string noExr = "no image", body = encoded(lease);
    const auto put = [&](const std::string& to, const std::string& bytes, const httplib::Headers& headers) {
        return client.Put(to.c_str(), headers, bytes, "image/x-exr")->status;
    };
    EXPECT_EQ(put(path, noExr, {{"Content-Digest", contentDigest(noExr)}}), 422);
    EXPECT_EQ(put(path, body, {}), 400);
    EXPECT_EQ(put(path, body, {{"Content-Digest", "sha-256=:abc:"}}), 400);
    EXPECT_EQ(put("/v1/leases/" + lease.id + "/result", body, {{"Content-Digest", contentDigest(body)}}),
              400);
    EXPECT_EQ(put(path + "1", body, {{"Content-Digest", contentDigest(body)}}), 409);
    EXPECT_EQ(put("/v1/leases/none/result?epoch=1", body, {{"Content-Digest", contentDigest(body)}}), 404);
    const std::string huge(4 << 20, 'x');
    EXPECT_EQ(put(path, huge, {{"Content-Digest", contentDigest(huge)}}), 413);
    EXPECT_EQ(upload(lease)->status, 200);
}

TEST_F(ApiTest, MergesAResultWhileOthersArriveOverLinesThatStall) {
    submit();
    const Lease lease = leaseFromJson(parsed(askForWork()));
    const std::string body = encoded(lease);
    const std::string head = "PUT /v1/leases/" + lease.id + "/result?epoch=" + std::to_string(lease.epoch) +
                             " HTTP/1.1\r\nHost: x\r\nContent-Digest: " + contentDigest(body) +
                             "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n";
    std::vector<RawConnection> stalled;
    for (int i = 0; i < 8; ++i) {
        stalled.emplace_back(server.port());
        stalled.back().send(head + body.substr(0, body.size() / 2));
    }
    client.set_read_timeout(20);
    const auto receipt = upload(lease);
    ASSERT_TRUE(receipt) << "it waits for those that stall";
    EXPECT_EQ(receipt->status, 200);
    stalled[0].send(body.substr(body.size() / 2));
    EXPECT_NE(stalled[0].receive("alreadyMerged").find("\"alreadyMerged\":24"), std::string::npos);
}

TEST(UploadBody, GoesToAFileWhereMemoryIsSpent) {
    const TemporaryFolder folder;
    MemoryBudget budget(100);
    const std::string text(80, 'x');
    const auto bytes = std::as_bytes(std::span(text));
    std::optional<UploadBody> first(std::in_place, budget, folder.path(), 80);
    UploadBody second(budget, folder.path(), 80), open(budget, folder.path(), std::nullopt);
    EXPECT_TRUE(first->inMemory());
    for (UploadBody* body : {&*first, &second, &open}) {
        body->add(bytes.subspan(0, 30));
        body->add(bytes.subspan(30));
        EXPECT_EQ(body->take(), std::vector(bytes.begin(), bytes.end()));
    }
    EXPECT_FALSE(second.inMemory());
    EXPECT_FALSE(open.inMemory()) << "of a length that was not announced";
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "nothing is left, whatever ends this process";
    first.reset();
    EXPECT_TRUE(UploadBody(budget, folder.path(), 80).inMemory());
}

TEST(FairGate, LetsThemInInTheOrderInWhichTheyCame) {
    FairGate gate(1);
    std::vector<int> order;
    std::vector<std::thread> threads;
    {
        const FairGate::Pass inside(gate);
        for (int i = 0; i < 5; ++i) {
            threads.emplace_back([&, i] {
                const FairGate::Pass pass(gate);
                order.push_back(i);
            });
            while (gate.waiting() != static_cast<size_t>(i) + 1) std::this_thread::yield();
        }
        EXPECT_TRUE(order.empty());
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(order, (std::vector{0, 1, 2, 3, 4}));
}

TEST_F(ApiTest, GivesEachLeaseCallItsAnswer) {
    const std::string id = submit()["id"];
    const Lease lease = leaseFromJson(parsed(askForWork()));
    const std::string path = "/v1/leases/" + lease.id;
    const json epoch{{"epoch", lease.epoch}};
    EXPECT_EQ(parsed(post(path + "/renew", epoch))["renewEveryMs"], 10000);
    EXPECT_EQ(post(path + "/renew", {{"epoch", lease.epoch + 1}})->status, 409);
    EXPECT_EQ(post(path + "/renew", json::object())->status, 400);
    EXPECT_EQ(post("/v1/leases/none/renew", epoch)->status, 404);
    EXPECT_EQ(
        post(path + "/report", {{"epoch", lease.epoch},
                                {"warnings", {{{"feature", "KHR_x"}, {"where", "/a"}, {"instead", "b"}}}},
                                {"features", {{"used", {"textures"}}, {"leftOut", {"sky"}}}}})
            ->status,
        204);
    EXPECT_EQ(parsed(get("/v1/jobs/" + id + "/report"))["features"]["leftOut"], json({"sky"}));
    EXPECT_EQ(post(path + "/failure", {{"epoch", lease.epoch}})->status, 400);
    EXPECT_EQ(client.Post((path + "/failure").c_str(), "{\"message\":\"\xff\"}", "application/json")->status,
              400);
    EXPECT_EQ(post(path + "/failure", {{"epoch", lease.epoch}, {"message", "device lost"}})->status, 204);
    EXPECT_EQ(post(path + "/renew", epoch)->status, 409);

    const Lease second = leaseFromJson(parsed(askForWork()));
    EXPECT_EQ(post("/v1/leases/" + second.id + "/return", {{"epoch", second.epoch}})->status, 204);
    const Lease third = leaseFromJson(parsed(askForWork()));
    client.Post(("/v1/jobs/" + id + "/cancel").c_str());
    EXPECT_EQ(post("/v1/leases/" + third.id + "/renew", {{"epoch", third.epoch}})->status, 410);
    EXPECT_EQ(upload(third)->status, 410);
}

TEST_F(ApiTest, ListsFramesThatHaveNotBegunAsQueued) {
    JobSpec job = spec();
    job.frames = {.first = 3, .count = 2};
    const std::string path =
        "/v1/jobs/" + parsed(post("/v1/jobs", toJson(job)))["id"].get<std::string>() + "/frames";
    askForWork();
    const json frames = parsed(get(path))["frames"];
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[0]["frame"], 3);
    EXPECT_EQ(frames[0]["state"], "active");
    EXPECT_EQ(frames[1]["state"], "queued");
    EXPECT_TRUE(parsed(get(path + "/3")).contains("errorCurve"));
    EXPECT_EQ(parsed(get(path + "/4"))["state"], "queued");
    EXPECT_EQ(get(path + "/5")->status, 404);
    EXPECT_EQ(get(path + "/x")->status, 404);
}

TEST_F(ApiTest, RendersTheFramesOfAListInItsOrder) {
    json body = toJson(spec());
    body["frames"] = {{"list", "9,1-5x2"}};
    const json made = parsed(post("/v1/jobs", body));
    EXPECT_EQ(made["spec"]["frames"], json({{"first", 9}, {"count", 4}, {"step", 1}, {"list", "9,1-5x2"}}));
    const std::string job = "/v1/jobs/" + made["id"].get<std::string>(), path = job + "/frames";
    std::vector<int32_t> rendered;
    while (parsed(get(job))["state"] != "completed") {
        const auto answer = askForWork();
        ASSERT_EQ(answer->status, 201);
        const Lease lease = leaseFromJson(parsed(answer));
        if (rendered.empty() || lease.frame != rendered.back()) rendered.push_back(lease.frame);
        ASSERT_EQ(upload(lease)->status, 200);
        farm.images->finishFrames();
    }
    EXPECT_EQ(rendered, (std::vector<int32_t>{9, 1, 3, 5}));
    EXPECT_EQ(parsed(get(job))["framesDone"], 4);
    EXPECT_EQ(parsed(get(path)).at("frames").size(), 4u);
    EXPECT_EQ(get(path + "/9/image.exr")->status, 200);
    EXPECT_EQ(get(path + "/2")->status, 404);
}

}  // namespace
}  // namespace tilefarm
