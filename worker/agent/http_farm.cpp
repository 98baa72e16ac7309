#include "worker/agent/http_farm.h"

#include <nlohmann/json.hpp>

namespace tilefarm {
namespace {

nlohmann::json toJson(const PreparedScene& scene) {
    auto warnings = nlohmann::json::array();
    for (const SceneWarning& w : scene.warnings)
        warnings.push_back({{"feature", w.feature}, {"where", w.where}, {"instead", w.instead}});
    return {{"warnings", warnings},
            {"features", {{"used", scene.features.used}, {"leftOut", scene.features.leftOut}}},
            {"counts",
             {{"triangles", scene.counts.triangles},
              {"degenerateTriangles", scene.counts.degenerateTriangles},
              {"sanitisedTexels", scene.counts.sanitisedTexels}}},
            {"prepareSeconds", scene.seconds()}};
}

class HttpFarm : public Farm {
public:
    HttpFarm(const std::string& url, const std::string& token) : client_(url, token) {}

    std::variant<Lease, NoWork> lease(const WorkerHello& hello, double wantSeconds) override {
        return client_.lease(hello, wantSeconds);
    }
    void getBlob(const std::string& sha256, const std::filesystem::path& file) override {
        client_.getBlob(sha256, file);
    }
    void renew(const std::string& leaseId, uint64_t epoch) override { client_.renew(leaseId, epoch); }
    ResultReceipt upload(const ResultUpload& result) override { return client_.upload(result); }
    void handBack(const std::string& leaseId, uint64_t epoch) override { client_.handBack(leaseId, epoch); }
    void reportFailure(const std::string& leaseId, uint64_t epoch, const std::string& message) override {
        client_.reportFailure(leaseId, epoch, message);
    }
    void reportScene(const std::string& leaseId, uint64_t epoch, const PreparedScene& scene) override {
        client_.reportScene(leaseId, epoch, toJson(scene));
    }

private:
    FarmClient client_;
};

}  // namespace

std::unique_ptr<Farm> makeHttpFarm(const std::string& url, const std::string& token) {
    return std::make_unique<HttpFarm>(url, token);
}

}  // namespace tilefarm
