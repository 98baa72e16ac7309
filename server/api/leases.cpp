#include <openssl/evp.h>

#include <nlohmann/json.hpp>

#include "server/api/resources.h"
#include "server/api/services.h"
#include "server/api/views.h"
#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "shared/image/exr.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr uint64_t kMostSmallBody = 1 << 20;
constexpr uint64_t kPartOverhead = 4096;  // headers and offsets of one part of an upload, generously

[[noreturn]] void badMember(const std::string& pointer, const std::string& message) {
    throw Error(ErrorCode::invalidArgument, pointer + " " + message, {{pointer, message}});
}

json objectOf(HttpRequest& r) {
    json body = parseJson(r.body(kMostSmallBody));
    if (!body.is_object()) badMember("", "must be an object");
    return body;
}

uint64_t epochOf(const json& body) {
    if (!body.contains("epoch") || !body["epoch"].is_number_unsigned())
        badMember("/epoch", "must be a whole number");
    return body["epoch"];
}

// "sha-256=:<base64>:" of RFC 9530 -> hex.
std::string digestOf(const HttpRequest& r) {
    const std::string header = r.header("Content-Digest"), key = "sha-256=:";
    const size_t from = header.find(key);
    const size_t end = from == std::string::npos ? from : header.find(':', from + key.size());
    if (end == std::string::npos || end - from - key.size() != 44) {
        throw Error(ErrorCode::invalidArgument, "the header Content-Digest must hold sha-256=:<base64>:");
    }
    unsigned char bytes[33];
    const auto* text = reinterpret_cast<const unsigned char*>(header.data()) + from + key.size();
    if (EVP_DecodeBlock(bytes, text, 44) != 33) {
        throw Error(ErrorCode::invalidArgument, "the header Content-Digest holds no base64");
    }
    std::string hex;
    for (size_t i = 0; i < 32; ++i) {
        hex += "0123456789abcdef"[bytes[i] >> 4];
        hex += "0123456789abcdef"[bytes[i] & 15];
    }
    return hex;
}

uint64_t largestUpload(const ResultTarget& target) {
    uint64_t bytes = kMostSmallBody;
    const uint64_t floats = filmLayoutOf(target.job->spec).floats();
    for (const LeasedPass& pass : target.lease.passes) {
        bytes += target.job->grid.rect(pass.tile).area() * (sizeof(PassPixel) + floats * sizeof(float)) +
                 kPartOverhead + 64 * floats + uint64_t{32} * target.job->grid.rect(pass.tile).height;
    }
    return bytes;
}

void receive(HttpRequest& r, const ResultTarget& target, UploadBody& body) {
    const std::string wanted = digestOf(r);
    Sha256 digest;
    r.readBody(largestUpload(target), [&](std::span<const std::byte> piece) {
        digest.update(piece);
        body.add(piece);
    });
    if (const std::string actual = digest.finishHex(); actual != wanted) {
        throw Error(ErrorCode::unprocessable,
                    "the body has the SHA-256 " + actual + ", but was announced as " + wanted);
    }
}

void countFaults(Metrics& metrics, const std::vector<PassFilm>& films) {
    uint64_t dropped = 0;
    PassFaults faults;
    for (const PassFilm& film : films) {
        faults.add(film.faults);
        for (const PassPixel& pixel : film.pixels)
            dropped += film.samples.count - static_cast<uint64_t>(pixel.count);
    }
    metrics.faults(dropped, faults);
}

}  // namespace

HttpResponse listWorkers(Services& s, HttpRequest&) {
    json list = json::array();
    for (const WorkerRow& worker : s.scheduler.workers()) {
        list.push_back(workerView(worker, s.scheduler.workerRate(worker.hello.worker)));
    }
    return jsonResponse(200, dump({{"workers", list}}));
}

HttpResponse postLease(Services& s, HttpRequest& r) {
    const json body = objectOf(r);
    json helloJson = body;
    helloJson.erase("wantSeconds");
    const WorkerHello hello = helloFromJson(helloJson);
    if (hello.version != TILEFARM_VERSION) {
        throw Error(ErrorCode::versionRefused,
                    "the worker is version " + hello.version + ", this server wants " + TILEFARM_VERSION);
    }
    const double want = body.contains("wantSeconds") && body["wantSeconds"].is_number()
                            ? body["wantSeconds"].get<double>()
                            : 5.0;
    const auto answer = s.scheduler.lease(hello, want);
    if (const auto* lease = std::get_if<Lease>(&answer)) {
        s.metrics.leases(1);
        return jsonResponse(201, dump(toJson(*lease)));
    }
    const auto& none = std::get<NoLease>(answer);
    auto response = emptyResponse(204);
    const auto ms = none.retryAfter.count();
    response.headers.emplace("Retry-After", std::to_string((ms + 999) / 1000));
    response.headers.emplace("Tilefarm-Retry-After-Ms", std::to_string(ms));
    if (!none.reason.empty()) response.headers.emplace("Tilefarm-Reason", none.reason);
    return response;
}

HttpResponse renewLease(Services& s, HttpRequest& r) {
    s.scheduler.renew(r.parameter("lease"), epochOf(objectOf(r)));
    const auto ms = s.scheduler.leaseTime().count();
    return jsonResponse(200, dump({{"expiresInMs", ms}, {"renewEveryMs", ms / 3}}));
}

HttpResponse putResult(Services& s, HttpRequest& r) {
    const uint64_t epoch = r.queriedInteger("epoch", 0, INT64_MAX);
    const double seconds = r.queriedNumber("deviceSeconds", 0, 1e9, 0);
    const auto target = s.scheduler.resultTarget(r.parameter("lease"), epoch);
    s.requireDiskSpace(r.contentLength.value_or(largestUpload(target)));
    UploadBody body(s.uploadMemory, s.config.uploads, r.contentLength);
    receive(r, target, body);
    const FairGate::Pass pass(s.decoders);
    const auto films = decodePassFilms(body.take());
    const ResultReceipt receipt = s.merger.accept(target, films, seconds);
    s.metrics.result(receipt, r.contentLength.value_or(0));
    countFaults(s.metrics, films);
    return jsonResponse(200, dump(toJson(receipt)));
}

HttpResponse returnLease(Services& s, HttpRequest& r) {
    s.scheduler.handBack(r.parameter("lease"), epochOf(objectOf(r)));
    return emptyResponse(204);
}

HttpResponse failLease(Services& s, HttpRequest& r) {
    const json body = objectOf(r);
    const json message = body.value("message", json());
    if (!message.is_string()) badMember("/message", "must be a text");
    s.scheduler.reportFailure(r.parameter("lease"), epochOf(body), message);
    s.metrics.failures(1);
    return emptyResponse(204);
}

HttpResponse reportOnLease(Services& s, HttpRequest& r) {
    json body = objectOf(r);
    const uint64_t epoch = epochOf(body);
    body.erase("epoch");
    s.scheduler.putReport(r.parameter("lease"), epoch, dump(body));
    return emptyResponse(204);
}

}  // namespace tilefarm
