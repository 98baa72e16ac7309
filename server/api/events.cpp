#include <nlohmann/json.hpp>

#include "server/api/resources.h"
#include "server/api/services.h"
#include "server/api/views.h"
#include "shared/error/error.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr size_t kPage = 500;
constexpr Milliseconds kWait{1000};
constexpr int kWaitsPerComment = 15;  // a comment line now and then, to notice clients that left

// "after" of the query, or where a reconnecting event source stopped; -1: from now on.
int64_t startOf(const HttpRequest& r) {
    const std::string last = r.header("Last-Event-ID");
    if (!last.empty() && last.find_first_not_of("0123456789") == std::string::npos && last.size() < 19) {
        return std::stoll(last);
    }
    return r.queried("after") ? static_cast<int64_t>(r.queriedInteger("after", 0, INT64_MAX)) : -1;
}

std::vector<EventRow> eventsAfter(const Services& s, int64_t after, std::optional<JobKey> job) {
    std::vector<EventRow> events;
    s.store.read([&](const ConstTables& t) { events = t.events.list(after, job, kPage); });
    return events;
}

HttpResponse polled(Services& s, int64_t after, std::optional<JobKey> job) {
    json list = json::array();
    for (const EventRow& event : eventsAfter(s, std::max<int64_t>(after, 0), job)) {
        list.push_back(eventView(event));
        after = event.id;
    }
    return jsonResponse(200, dump({{"events", list}, {"after", std::max<int64_t>(after, 0)}}));
}

class EventStream {
public:
    EventStream(Services& s, int64_t after, std::optional<JobKey> job) : s_(s), after_(after), job_(job) {
        if (after_ < 0) s.store.read([&](const ConstTables& t) { after_ = t.events.lastId(); });
    }
    bool next(const StreamSink& sink) {
        const uint64_t known = s_.events.version();
        const auto events = eventsAfter(s_, after_, job_);
        for (const EventRow& event : events) {
            const std::string text = "id: " + std::to_string(event.id) + "\nevent: " + event.type +
                                     "\ndata: " + dump(eventView(event)) + "\n\n";
            if (!sink(text)) return false;
            after_ = event.id;
        }
        if (!events.empty() || first_) waits_ = 0;
        if (std::exchange(first_, false) && !sink(": tilefarm\n\n")) return false;
        if (++waits_ % kWaitsPerComment == 0 && !sink(": still here\n\n")) return false;
        if (events.size() < kPage) s_.events.waitBeyond(known, kWait);
        return !s_.events.closed();
    }

private:
    Services& s_;
    int64_t after_;
    std::optional<JobKey> job_;
    int waits_ = 0;
    bool first_ = true;
};

HttpResponse respond(Services& s, const HttpRequest& r, std::optional<JobKey> job) {
    const std::string accept = r.header("Accept");
    const int64_t after = startOf(r);
    if (accept.find("text/event-stream") == std::string::npos &&
        (r.queried("after") || accept.find("application/json") != std::string::npos)) {
        return polled(s, after, job);
    }
    HttpResponse response;
    response.type = "text/event-stream";
    response.headers.emplace("Cache-Control", "no-store");
    auto stream = std::make_shared<EventStream>(s, after, job);
    response.body = HttpResponse::Stream([stream](const StreamSink& sink) { return stream->next(sink); });
    return response;
}

}  // namespace

HttpResponse jobEvents(Services& s, HttpRequest& r) {
    JobKey key = 0;
    s.store.read([&](const ConstTables& t) { key = requireJob(t, r.parameter("job")).key; });
    return respond(s, r, key);
}

HttpResponse allEvents(Services& s, HttpRequest& r) {
    return respond(s, r, std::nullopt);
}

}  // namespace tilefarm
