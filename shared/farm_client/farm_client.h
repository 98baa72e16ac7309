#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "shared/job/job.h"
#include "shared/job/lease.h"

namespace tilefarm {

/// No work now; ask again after this long.
struct NoWork {
    uint32_t retryAfterMs = 1000;
};

/// What a worker says with a finished lease.
struct ResultUpload {
    std::string leaseId;
    uint64_t epoch = 0;
    std::span<const std::byte> exr;  // encodePassFilms
    std::string sha256;              // of `exr`
    double deviceSeconds = 0;        // time the device was busy with it
};

/// HTTP client of the REST API, for workers and the command line. Every call throws Error: the code
/// of the status the server answered (problem+json gives the message and faults), or
/// Error(unavailable) that names the server when it cannot be reached. Calls do not retry by
/// themselves. One object per thread.
class FarmClient {
public:
    /// `url` like http://host:port (or https). Throws Error(invalidArgument) if it is none. Makes the
    /// process ignore SIGPIPE.
    explicit FarmClient(std::string url, std::string token = {});
    ~FarmClient();

    // Blobs
    std::vector<std::string> missingBlobs(const std::vector<std::string>& digests);
    void putBlob(const std::string& sha256, const std::filesystem::path& file);
    /// Streams into `file`, which is whole or absent; the caller checks the digest.
    void getBlob(const std::string& sha256, const std::filesystem::path& file);

    // Jobs; answers are the API's own JSON
    nlohmann::json submit(const JobSpec& spec, const std::string& idempotencyKey = {});
    nlohmann::json validate(const JobSpec& spec);
    /// Starts the pilot of a job; what the API answers, with the path of the forecast.
    nlohmann::json startForecast(const JobSpec& spec);
    /// `path`: of startForecast, with further query parameters.
    nlohmann::json forecast(const std::string& path);
    nlohmann::json jobs(const std::string& query = {});
    nlohmann::json job(const std::string& id);
    nlohmann::json cancel(const std::string& id);
    nlohmann::json pause(const std::string& id);
    nlohmann::json resume(const std::string& id);
    nlohmann::json workers();

    // Studies, likewise
    nlohmann::json submitStudy(const nlohmann::json& request);
    nlohmann::json study(const std::string& id);
    nlohmann::json studies(const std::string& query = {});
    nlohmann::json cancelStudy(const std::string& id);

    /// Any GET below /v1 streamed into a file, as for "/v1/jobs/7/frames/0/image.exr". The file is
    /// whole or absent.
    void download(const std::string& path, const std::filesystem::path& file);

    // Leases
    std::variant<Lease, NoWork> lease(const WorkerHello& hello, double wantSeconds);
    /// Keeps a lease. Throws Error(conflict | gone | notFound) if it is no longer held.
    void renew(const std::string& leaseId, uint64_t epoch);
    ResultReceipt upload(const ResultUpload& result);
    void handBack(const std::string& leaseId, uint64_t epoch);
    void reportFailure(const std::string& leaseId, uint64_t epoch, const std::string& message);
    /// Once per worker and job: {"warnings", "features", "prepareSeconds"} as the API has them.
    void reportScene(const std::string& leaseId, uint64_t epoch, const nlohmann::json& report);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm
