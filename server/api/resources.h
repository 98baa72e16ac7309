#pragma once

#include "server/api/http.h"

// The handlers of the routes table, a file per resource.
namespace tilefarm {

struct Services;

HttpResponse putBlob(Services& s, HttpRequest& r);
HttpResponse getBlob(Services& s, HttpRequest& r);
HttpResponse missingBlobs(Services& s, HttpRequest& r);

HttpResponse postJob(Services& s, HttpRequest& r);
HttpResponse listJobs(Services& s, HttpRequest& r);
HttpResponse getJob(Services& s, HttpRequest& r);
HttpResponse cancelJob(Services& s, HttpRequest& r);
HttpResponse pauseJob(Services& s, HttpRequest& r);
HttpResponse resumeJob(Services& s, HttpRequest& r);
HttpResponse getReport(Services& s, HttpRequest& r);

HttpResponse postForecast(Services& s, HttpRequest& r);
HttpResponse getForecast(Services& s, HttpRequest& r);

HttpResponse listFrames(Services& s, HttpRequest& r);
HttpResponse getFrame(Services& s, HttpRequest& r);
HttpResponse getExr(Services& s, HttpRequest& r);
HttpResponse getMatteManifest(Services& s, HttpRequest& r);
HttpResponse getPng(Services& s, HttpRequest& r);
HttpResponse getPreview(Services& s, HttpRequest& r);

HttpResponse postStudy(Services& s, HttpRequest& r);
HttpResponse listStudies(Services& s, HttpRequest& r);
HttpResponse getStudy(Services& s, HttpRequest& r);
HttpResponse cancelStudy(Services& s, HttpRequest& r);
HttpResponse getStudyCsv(Services& s, HttpRequest& r);
HttpResponse getStudyReport(Services& s, HttpRequest& r);

HttpResponse jobEvents(Services& s, HttpRequest& r);
HttpResponse allEvents(Services& s, HttpRequest& r);

HttpResponse listWorkers(Services& s, HttpRequest& r);
HttpResponse postLease(Services& s, HttpRequest& r);
HttpResponse renewLease(Services& s, HttpRequest& r);
HttpResponse putResult(Services& s, HttpRequest& r);
HttpResponse returnLease(Services& s, HttpRequest& r);
HttpResponse failLease(Services& s, HttpRequest& r);
HttpResponse reportOnLease(Services& s, HttpRequest& r);

HttpResponse getOpenApi(Services& s, HttpRequest& r);
HttpResponse getHealth(Services& s, HttpRequest& r);
HttpResponse getMetrics(Services& s, HttpRequest& r);
HttpResponse getStatusPage(Services& s, HttpRequest& r);

}  // namespace tilefarm
