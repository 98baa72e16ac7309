#include <cstring>
#include <nlohmann/json.hpp>

#include "server/api/resources.h"
#include "server/api/services.h"
#include "server/api/views.h"
#include "server/report/accuracy.h"
#include "shared/digest/digest.h"
#include "shared/error/error.h"
#include "shared/image/tone.h"

namespace tilefarm {
namespace {

using nlohmann::json;

FrameRow waiting(JobKey job, int32_t number) {
    FrameRow row;
    row.job = job;
    row.frame = number;
    return row;
}

// A frame without a row has not begun.
json viewOf(const std::optional<FrameRow>& row, const JobInfo& info, int32_t number) {
    json view = frameView(row.value_or(waiting(info.key, number)), info.spec.stop);
    if (!row) view["state"] = "queued";
    return view;
}

ToneMapping toneOf(const HttpRequest& r) {
    ToneMapping mapping;
    mapping.exposure = static_cast<float>(r.queriedNumber("exposure", -64, 64, 0));
    if (const auto tone = r.queried("tone")) mapping.curve = toneCurveFrom(*tone);
    return mapping;
}

HttpResponse pictureResponse(HttpRequest& r, const Picture& picture) {
    auto response = contentResponse(
        r, "image/png", picture.sha256,
        {picture.png->size(), [png = picture.png](uint64_t offset, std::span<std::byte> into) {
             std::copy_n(png->begin() + static_cast<std::ptrdiff_t>(offset), into.size(), into.begin());
         }});
    response.headers.emplace("Tilefarm-State", picture.partial ? "partial" : "complete");
    return response;
}

}  // namespace

HttpResponse listFrames(Services& s, HttpRequest& r) {
    json list = json::array();
    s.store.read([&](const ConstTables& t) {
        const JobRow job = requireJob(t, r.parameter("job"));
        const auto info = s.scheduler.catalog().get(t, job);
        for (const FrameRow& frame : t.frames.list(job.key))
            list.push_back(frameView(frame, info->spec.stop));
        for (uint32_t i = job.framesStarted; i < job.frames; ++i) {
            list.push_back(viewOf(std::nullopt, *info, info->frame(i)));
        }
    });
    return jsonResponse(200, dump({{"frames", list}}));
}

HttpResponse getFrame(Services& s, HttpRequest& r) {
    const int32_t number = frameNumber(r.parameter("frame"));
    HttpResponse response;
    s.store.read([&](const ConstTables& t) {
        const JobRow job = requireJob(t, r.parameter("job"));
        const auto info = s.scheduler.catalog().get(t, job);
        if (!info->hasFrame(number)) {
            throw Error(ErrorCode::notFound, "job '" + job.id + "' has no frame " + std::to_string(number));
        }
        json view = viewOf(t.frames.find(job.key, number), *info, number);
        addAccuracy(view, t, job.key, number, info->spec.image);
        response = jsonResponse(200, dump(view));
    });
    return response;
}

HttpResponse getExr(Services& s, HttpRequest& r) {
    const ImageFile image = s.images.exr(r.parameter("job"), frameNumber(r.parameter("frame")));
    auto response = contentResponse(
        r, "image/x-exr", image.sha256,
        {image.bytes,
         [file = image.file](uint64_t offset, std::span<std::byte> into) { file->readAt(offset, into); }});
    response.headers.emplace("Tilefarm-State", image.partial ? "partial" : "complete");
    return response;
}

HttpResponse getMatteManifest(Services& s, HttpRequest& r) {
    const auto text =
        std::make_shared<const std::string>(s.images.sidecar(r.parameter("job"), r.parameter("file")));
    return contentResponse(r, "application/json", sha256Hex(*text),
                           {text->size(), [text](uint64_t offset, std::span<std::byte> into) {
                                std::memcpy(into.data(), text->data() + offset, into.size());
                            }});
}

HttpResponse getPng(Services& s, HttpRequest& r) {
    return pictureResponse(r, s.images.png(r.parameter("job"), frameNumber(r.parameter("frame")), toneOf(r),
                                           0, r.queriedFlag("denoised")));
}

HttpResponse getPreview(Services& s, HttpRequest& r) {
    const auto width = static_cast<uint32_t>(r.queriedInteger("width", 16, 4096, 640));
    return pictureResponse(r, s.images.png(r.parameter("job"), frameNumber(r.parameter("frame")), toneOf(r),
                                           width, r.queriedFlag("denoised")));
}

}  // namespace tilefarm
