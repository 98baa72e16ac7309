#include <nlohmann/json.hpp>

#include "server/api/openapi.h"
#include "server/api/resources.h"
#include "server/api/services.h"
#include "server/web/status_page.h"
#include "shared/job/wire.h"

namespace tilefarm {

HttpResponse getOpenApi(Services&, HttpRequest&) {
    // The job's schema comes from the table that also checks jobs, so it cannot differ from what is accepted.
    static const std::string document = [] {
        auto json = nlohmann::json::parse(openApiJson());
        json["components"]["schemas"]["Job"] = jobSchema();
        return json.dump();
    }();
    return jsonResponse(200, document);
}

HttpResponse getHealth(Services& s, HttpRequest&) {
    s.store.read([](const ConstTables& t) { t.events.lastId(); });  // the database answers
    return jsonResponse(200, R"({"status":"ok","version":")" TILEFARM_VERSION R"("})");
}

HttpResponse getMetrics(Services& s, HttpRequest&) {
    auto response = jsonResponse(200, s.metrics.text(s.store, s.scheduler.openLeases(), s.clock.now()));
    response.type = "text/plain; version=0.0.4";
    return response;
}

HttpResponse getStatusPage(Services&, HttpRequest&) {
    auto response = jsonResponse(200, std::string(statusPage()));
    response.type = "text/html; charset=utf-8";
    response.headers.emplace("Content-Security-Policy",
                             "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
                             "img-src 'self' blob: data:; connect-src 'self'");
    return response;
}

}  // namespace tilefarm
