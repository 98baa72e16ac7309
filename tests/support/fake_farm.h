#pragma once

#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace tilefarm {

/// A server of the REST API (blobs, jobs, leases) on a free port of the loopback that behaves: it
/// keeps blobs in memory and checks their digests, checks jobs as the real one does, and lets a job
/// come closer to its end by a third with every look at it. What it was told, it remembers.
class FakeFarm {
public:
    struct Seen {
        std::string method, path, body, authorization, contentDigest, idempotencyKey;
        int port = 0;  // of the client: equal ports, one connection
    };

    FakeFarm();
    ~FakeFarm();

    std::string url() const;
    /// From now on every request is answered so, until `clear`.
    void answerAll(int status, std::string body, std::string contentType = "application/problem+json",
                   std::map<std::string, std::string> headers = {});
    void clear();
    /// The state that jobs end in: completed, unless said otherwise.
    void endJobsAs(std::string state);
    /// The bytes of every image.exr and image.png.
    void setImage(std::string bytes);
    /// Hands out this lease JSON once.
    void offerLease(std::string leaseJson);

    std::vector<Seen> seen() const;
    size_t count(const std::string& method, const std::string& pathPrefix) const;
    std::map<std::string, std::string> blobs() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm
