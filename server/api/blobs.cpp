#include <nlohmann/json.hpp>

#include "server/api/resources.h"
#include "server/api/services.h"
#include "server/api/views.h"
#include "server/store/file.h"
#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "shared/job/wire.h"

namespace tilefarm {

void Services::requireDiskSpace(uint64_t bytes) const {
    if (config.leastFreeBytes == 0) return;
    const uint64_t free = freeBytes(config.folder);
    if (free >= config.leastFreeBytes + bytes) return;
    throw Error(ErrorCode::outOfSpace, "the server's disk has " + std::to_string(free >> 20) +
                                           " MiB free; uploads and jobs need at least " +
                                           std::to_string(config.leastFreeBytes >> 20) + " MiB");
}

HttpResponse putBlob(Services& s, HttpRequest& r) {
    const std::string& sha256 = r.parameter("sha256");
    s.requireDiskSpace(r.contentLength.value_or(0));
    const auto writer = s.blobs.create(sha256);
    r.readBody(s.config.mostBlobBytes, [&](std::span<const std::byte> bytes) { writer->write(bytes); });
    const bool isNew = writer->commit();
    return jsonResponse(isNew ? 201 : 200, dump({{"sha256", sha256}, {"bytes", *s.blobs.size(sha256)}}));
}

HttpResponse getBlob(Services& s, HttpRequest& r) {
    const std::string sha256 = r.parameter("sha256");
    const auto bytes = s.blobs.size(sha256);
    if (!bytes) throw Error(ErrorCode::notFound, "there is no blob " + sha256);
    return contentResponse(r, "application/octet-stream", sha256,
                           {*bytes, [&blobs = s.blobs, sha256](uint64_t offset, std::span<std::byte> into) {
                                blobs.read(sha256, offset, into);
                            }});
}

HttpResponse missingBlobs(Services& s, HttpRequest& r) {
    const auto request = parseJson(r.body(s.config.mostJsonBytes));
    const auto list =
        request.is_object() && request.contains("sha256") ? request["sha256"] : nlohmann::json();
    if (!list.is_array()) {
        throw Error(ErrorCode::invalidArgument, "a list of digests is expected",
                    {{"/sha256", "must be a list"}});
    }
    std::vector<Fault> faults;
    std::vector<std::string> missing;
    for (size_t i = 0; i < list.size(); ++i) {
        if (!list[i].is_string() || !isSha256Hex(list[i].get<std::string>())) {
            faults.push_back({"/sha256/" + std::to_string(i), "must be 64 lower-case hex digits"});
        } else if (!s.blobs.size(list[i])) {
            missing.push_back(list[i]);
        }
    }
    if (!faults.empty())
        throw Error(ErrorCode::invalidArgument, "some entries are not SHA-256 digests", std::move(faults));
    return jsonResponse(200, dump({{"missing", missing}}));
}

}  // namespace tilefarm
