#include "tests/support/fake_farm.h"

#include <httplib.h>

#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "shared/job/wire.h"

namespace tilefarm {

using httplib::Request;
using httplib::Response;
using nlohmann::json;

namespace {

struct Canned {
    int status;
    std::string body, contentType;
    std::map<std::string, std::string> headers;
};

void problem(Response& answer, int status, const std::string& detail, const std::vector<Fault>& faults = {}) {
    json errors = json::array();
    for (const Fault& fault : faults)
        errors.push_back({{"pointer", fault.pointer}, {"message", fault.message}});
    answer.status = status;
    answer.set_content(
        json{{"title", "fault"}, {"status", status}, {"detail", detail}, {"errors", errors}}.dump(),
        "application/problem+json");
}

void give(Response& answer, int status, const json& body) {
    answer.status = status;
    answer.set_content(body.dump(), "application/json");
}

}  // namespace

struct FakeFarm::Impl {
    mutable std::mutex mutex;
    httplib::Server server;
    std::thread thread;
    int port = 0;

    std::vector<Seen> seen;
    std::optional<Canned> canned;
    std::map<std::string, std::string> blobs;
    std::vector<json> jobs;  // views; the id is the index + 1
    std::string endState = "completed", image = "image bytes", lease;

    Impl() {
        server.set_pre_routing_handler([this](const Request&, Response& answer) { return fromCan(answer); });
        server.set_logger([](const Request&, const Response&) {});
        on("PUT", "/v1/blobs/([0-9a-f]+)", [this](auto& q, auto& a) { putBlob(q, a); });
        on("GET", "/v1/blobs/([0-9a-f]+)", [this](auto& q, auto& a) { getBlob(q, a); });
        on("POST", "/v1/blobs/missing", [this](auto& q, auto& a) { missing(q, a); });
        on("POST", "/v1/jobs", [this](auto& q, auto& a) { submit(q, a); });
        on("GET", "/v1/jobs", [this](auto&, auto& a) { give(a, 200, {{"jobs", jobs}, {"next", nullptr}}); });
        on("GET", "/v1/jobs/([^/]+)",
           [this](auto& q, auto& a) { onJob(q, a, [this](json& j) { step(j); }); });
        for (const auto& [action, state] :
             {std::pair{"cancel", "canceled"}, {"pause", "paused"}, {"resume", "running"}})
            on("POST", std::string("/v1/jobs/([^/]+)/") + action,
               [this, to = std::string(state)](auto& q, auto& a) {
                   onJob(q, a, [&](json& j) { j["state"] = to; });
               });
        on("GET", "/v1/jobs/([^/]+)/frames/(-?[0-9]+)/image.(exr|png)",
           [this](auto&, auto& a) { a.set_content(image, "application/octet-stream"); });
        on("GET", "/v1/workers", [](auto&, auto& a) {
            give(a, 200,
                 {{"workers",
                   {{{"worker", "w1"}, {"host", "h"}, {"device", "llvmpipe"}, {"state", "online"}}}}});
        });
        on("POST", "/v1/leases", [this](auto& q, auto& a) { giveLease(q, a); });
        on("POST", "/v1/leases/([^/]+)/renew", [](auto&, auto& a) {
            give(a, 200, {{"expiresInMs", 30000}});
        });
        on("PUT", "/v1/leases/([^/]+)/result", [](auto&, auto& a) {
            give(a, 200, {{"merged", 2}, {"alreadyMerged", 1}});
        });
        for (const char* action : {"return", "failure", "report"})
            on("POST", std::string("/v1/leases/([^/]+)/") + action, [](auto&, auto& a) { a.status = 204; });
        server.set_tcp_nodelay(true);
        port = server.bind_to_any_port("127.0.0.1");
        thread = std::thread([this] { server.listen_after_bind(); });
        while (!server.is_running()) std::this_thread::yield();
    }

    template <typename Handle>
    void on(const char* method, const std::string& path, Handle handle) {
        const auto remember = [this, handle](const Request& q, Response& a) {
            const std::lock_guard lock(mutex);
            seen.push_back({q.method, q.target, q.body, q.get_header_value("Authorization"),
                            q.get_header_value("Content-Digest"), q.get_header_value("Idempotency-Key"),
                            q.remote_port});
            handle(q, a);
        };
        if (std::string_view(method) == "GET") server.Get(path, remember);
        if (std::string_view(method) == "PUT") server.Put(path, remember);
        if (std::string_view(method) == "POST") server.Post(path, remember);
    }

    httplib::Server::HandlerResponse fromCan(Response& answer) {
        const std::lock_guard lock(mutex);
        if (!canned) return httplib::Server::HandlerResponse::Unhandled;
        answer.status = canned->status;
        answer.set_content(canned->body, canned->contentType);
        for (const auto& [name, value] : canned->headers) answer.set_header(name, value);
        answer.set_header("Connection", "close");  // the body of the request is still unread
        return httplib::Server::HandlerResponse::Handled;
    }

    void putBlob(const Request& q, Response& a) {
        const std::string digest = q.matches[1];
        if (sha256Hex(q.body) != digest) return problem(a, 422, "the bytes are not those of " + digest);
        a.status = blobs.emplace(digest, q.body).second ? 201 : 200;
    }
    void getBlob(const Request& q, Response& a) {
        const auto found = blobs.find(q.matches[1]);
        if (found == blobs.end()) return problem(a, 404, "no blob " + q.matches[1].str());
        a.set_content(found->second, "application/octet-stream");
    }
    void missing(const Request& q, Response& a) {
        json list = json::array();
        const json asked = json::parse(q.body);
        for (const std::string digest : asked.at("sha256"))
            if (!blobs.contains(digest)) list.push_back(digest);
        give(a, 200, {{"missing", list}});
    }

    void submit(const Request& q, Response& a) {
        try {
            const JobSpec spec = jobFromJson(parseJson(q.body));
            std::vector<Fault> faults;
            for (const auto& [path, digest] : spec.scene.files)
                if (!blobs.contains(digest))
                    faults.push_back({"/scene/files/" + pointerToken(path), "is not on the server"});
            if (!faults.empty()) return problem(a, 422, "blobs are missing", faults);
            if (q.has_param("validate")) return give(a, 200, {{"valid", true}});
            const json view{{"id", std::to_string(jobs.size() + 1)},
                            {"state", "queued"},
                            {"spec", toJson(spec)},
                            {"createdAt", "2025-01-02T03:04:05Z"},
                            {"progress", {{"passes", 3}, {"passesMerged", 0}, {"fraction", 0.0}}},
                            {"samplesMerged", 0},
                            {"relativeError", nullptr},
                            {"deviceSeconds", 0.0},
                            {"droppedSamples", 0},
                            {"framesDone", 0},
                            {"faults", json::array()},
                            {"notices", json::array()},
                            {"errorCurve", json::array()}};
            jobs.push_back(view);
            give(a, 201, view);
        } catch (const Error& e) {
            problem(a, 400, e.what(), e.faults);
        }
    }

    template <typename Change>
    void onJob(const Request& q, Response& a, Change change) {
        const size_t index = static_cast<size_t>(std::atol(q.matches[1].str().c_str()));
        if (index < 1 || index > jobs.size()) return problem(a, 404, "no such job");
        change(jobs[index - 1]);
        give(a, 200, jobs[index - 1]);
    }

    void step(json& job) const {
        if (job["state"] != "queued" && job["state"] != "running") return;
        const int merged = job["progress"]["passesMerged"].get<int>() + 1;
        job["progress"] = {{"passes", 3}, {"passesMerged", merged}, {"fraction", merged / 3.0}};
        job["relativeError"] = 0.5 / merged;
        job["samplesMerged"] = merged;
        job["state"] = merged == 3 ? endState : "running";
        if (endState == "failed" && merged == 3) job["faults"] = {"no light in the scene"};
        job["notices"] = {"the bounce limit ended paths"};
    }

    void giveLease(const Request& q, Response& a) {
        (void)helloFromJson(parseJson(q.body));
        if (lease.empty()) {
            a.status = 204;
            a.set_header("Retry-After", "2");
            a.set_header("Tilefarm-Retry-After-Ms", "1500");
            return;
        }
        a.status = 201;
        a.set_content(std::exchange(lease, {}), "application/json");
    }
};

FakeFarm::FakeFarm() : impl_(std::make_unique<Impl>()) {}

FakeFarm::~FakeFarm() {
    impl_->server.stop();
    impl_->thread.join();
}

std::string FakeFarm::url() const {
    return "http://127.0.0.1:" + std::to_string(impl_->port);
}

void FakeFarm::answerAll(int status, std::string body, std::string contentType,
                         std::map<std::string, std::string> headers) {
    const std::lock_guard lock(impl_->mutex);
    impl_->canned = Canned{status, std::move(body), std::move(contentType), std::move(headers)};
}
void FakeFarm::clear() {
    const std::lock_guard lock(impl_->mutex);
    impl_->canned.reset();
}
void FakeFarm::endJobsAs(std::string state) {
    const std::lock_guard lock(impl_->mutex);
    impl_->endState = std::move(state);
}
void FakeFarm::setImage(std::string bytes) {
    const std::lock_guard lock(impl_->mutex);
    impl_->image = std::move(bytes);
}
void FakeFarm::offerLease(std::string leaseJson) {
    const std::lock_guard lock(impl_->mutex);
    impl_->lease = std::move(leaseJson);
}

std::vector<FakeFarm::Seen> FakeFarm::seen() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->seen;
}
size_t FakeFarm::count(const std::string& method, const std::string& pathPrefix) const {
    size_t n = 0;
    for (const Seen& request : seen()) n += request.method == method && request.path.starts_with(pathPrefix);
    return n;
}
std::map<std::string, std::string> FakeFarm::blobs() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->blobs;
}

}  // namespace tilefarm
