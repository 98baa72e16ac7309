#include "server/api/routes.h"

#include <openssl/crypto.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <set>

#include "server/api/problem.h"
#include "server/api/resources.h"
#include "server/api/services.h"

namespace tilefarm {
namespace {

constexpr std::array kRoutes{
    Route{"PUT", "/v1/blobs/{sha256}", putBlob},
    Route{"GET", "/v1/blobs/{sha256}", getBlob},
    Route{"POST", "/v1/blobs/missing", missingBlobs},
    Route{"POST", "/v1/jobs", postJob},
    Route{"GET", "/v1/jobs", listJobs},
    Route{"GET", "/v1/jobs/{job}", getJob},
    Route{"POST", "/v1/jobs/{job}/cancel", cancelJob},
    Route{"POST", "/v1/jobs/{job}/pause", pauseJob},
    Route{"POST", "/v1/jobs/{job}/resume", resumeJob},
    Route{"GET", "/v1/jobs/{job}/report", getReport},
    Route{"GET", "/v1/jobs/{job}/forecast", getForecast},
    Route{"POST", "/v1/forecasts", postForecast},
    Route{"GET", "/v1/jobs/{job}/mattes/{file}", getMatteManifest},
    Route{"GET", "/v1/jobs/{job}/frames", listFrames},
    Route{"GET", "/v1/jobs/{job}/frames/{frame}", getFrame},
    Route{"GET", "/v1/jobs/{job}/frames/{frame}/image.exr", getExr},
    Route{"GET", "/v1/jobs/{job}/frames/{frame}/image.png", getPng},
    Route{"GET", "/v1/jobs/{job}/frames/{frame}/preview.png", getPreview},
    Route{"GET", "/v1/jobs/{job}/events", jobEvents},
    Route{"POST", "/v1/studies", postStudy},
    Route{"GET", "/v1/studies", listStudies},
    Route{"GET", "/v1/studies/{study}", getStudy},
    Route{"POST", "/v1/studies/{study}/cancel", cancelStudy},
    Route{"GET", "/v1/studies/{study}/report.csv", getStudyCsv},
    Route{"GET", "/v1/studies/{study}/report.html", getStudyReport},
    Route{"GET", "/v1/events", allEvents},
    Route{"GET", "/v1/workers", listWorkers},
    Route{"POST", "/v1/leases", postLease},
    Route{"POST", "/v1/leases/{lease}/renew", renewLease},
    Route{"PUT", "/v1/leases/{lease}/result", putResult},
    Route{"POST", "/v1/leases/{lease}/return", returnLease},
    Route{"POST", "/v1/leases/{lease}/failure", failLease},
    Route{"POST", "/v1/leases/{lease}/report", reportOnLease},
    Route{"GET", "/v1/openapi.json", getOpenApi, true},
    Route{"GET", "/healthz", getHealth, true},
    Route{"GET", "/metrics", getMetrics},
    Route{"GET", "/", getStatusPage, true},
};

std::vector<std::string_view> segments(std::string_view path) {
    std::vector<std::string_view> parts;
    for (size_t from = 1; from <= path.size();) {
        const size_t end = std::min(path.find('/', from), path.size());
        parts.push_back(path.substr(from, end - from));
        from = end + 1;
    }
    return parts;
}

bool matches(std::string_view pattern, std::string_view path,
             std::map<std::string, std::string>& parameters) {
    const auto wanted = segments(pattern), given = segments(path);
    if (wanted.size() != given.size()) return false;
    std::map<std::string, std::string> found;
    for (size_t i = 0; i < wanted.size(); ++i) {
        if (wanted[i].starts_with('{')) {
            found.emplace(wanted[i].substr(1, wanted[i].size() - 2), given[i]);
        } else if (wanted[i] != given[i]) {
            return false;
        }
    }
    parameters = std::move(found);
    return true;
}

bool isRight(const Services& services, std::string_view authorization) {
    const std::string& token = services.config.token;
    if (token.empty()) return true;
    const std::string wanted = "Bearer " + token;
    return authorization.size() == wanted.size() &&
           CRYPTO_memcmp(authorization.data(), wanted.data(), wanted.size()) == 0;
}

const Error& wrongToken() {
    static const Error error(ErrorCode::unauthorized, "the bearer token is missing or wrong");
    return error;
}

void requireToken(const Services& services, const HttpRequest& request) {
    if (!isRight(services, request.header("Authorization"))) throw Error(wrongToken());
}

HttpResponse route(Services& services, HttpRequest& request) {
    const std::string_view method = request.method == "HEAD" ? "GET" : std::string_view(request.method);
    std::set<std::string> allowed;
    for (const Route& candidate : kRoutes) {
        if (!matches(candidate.pattern, request.path, request.parameters)) continue;
        if (candidate.method != method) {
            allowed.emplace(candidate.method);
            continue;
        }
        if (!candidate.open) requireToken(services, request);
        return candidate.handle(services, request);
    }
    requireToken(services, request);
    if (allowed.empty()) throw Error(ErrorCode::notFound, "there is no resource " + request.path);
    auto response = problemResponse(405, request.method + " is not allowed on " + request.path);
    std::string list;
    for (const std::string& word : allowed) list += (list.empty() ? "" : ", ") + word;
    response.headers.emplace("Allow", list);
    return response;
}

}  // namespace

std::optional<HttpResponse> refusedWithoutToken(const Services& services, std::string_view path,
                                                std::string_view authorization) {
    const auto isOpen = [&](const Route& route) { return route.open && route.pattern == path; };
    if (isRight(services, authorization) || std::any_of(kRoutes.begin(), kRoutes.end(), isOpen))
        return std::nullopt;
    return problemResponse(wrongToken());
}

std::span<const Route> routes() {
    return kRoutes;
}

HttpResponse dispatch(Services& services, HttpRequest& request) {
    try {
        return route(services, request);
    } catch (const Error& fault) {
        if (httpStatus(fault.code) >= 500)
            spdlog::error("{} {}: {}", request.method, request.path, fault.what());
        return problemResponse(fault);
    } catch (const std::exception& fault) {
        spdlog::error("{} {}: {}", request.method, request.path, fault.what());
        return problemResponse(Error(ErrorCode::internal, fault.what()));
    }
}

}  // namespace tilefarm
