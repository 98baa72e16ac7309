#pragma once

#include <filesystem>
#include <string>
#include <variant>

#include "shared/farm_client/farm_client.h"
#include "shared/job/lease.h"
#include "worker/agent/render_backend.h"

namespace tilefarm {

/// The server as a worker sees it. Calls throw Error as FarmClient says. One thread at a time; every
/// thread of a worker has its own.
struct Farm {
    virtual ~Farm() = default;
    virtual std::variant<Lease, NoWork> lease(const WorkerHello& hello, double wantSeconds) = 0;
    virtual void getBlob(const std::string& sha256, const std::filesystem::path& file) = 0;
    virtual void renew(const std::string& leaseId, uint64_t epoch) = 0;
    virtual ResultReceipt upload(const ResultUpload& result) = 0;
    virtual void handBack(const std::string& leaseId, uint64_t epoch) = 0;
    virtual void reportFailure(const std::string& leaseId, uint64_t epoch, const std::string& message) = 0;
    virtual void reportScene(const std::string& leaseId, uint64_t epoch, const PreparedScene& scene) = 0;
};

}  // namespace tilefarm
