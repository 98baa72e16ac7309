#include "server/queue/event_json.h"

#include <nlohmann/json.hpp>

namespace tilefarm {

using nlohmann::json;

namespace {
json maybe(const std::optional<double>& value) {
    return value ? json(*value) : json();
}
// Messages of workers may hold any bytes; what is no UTF-8 is replaced rather than refused.
std::string text(const json& value) {
    return value.dump(-1, ' ', false, json::error_handler_t::replace);
}
}  // namespace

std::string jobStateJson(const JobRow& job) {
    json data{{"job", job.id}, {"state", toString(job.state)}};
    if (!job.faults.empty()) data["faults"] = job.faults;
    if (!job.setAside.empty()) data["setAside"] = job.setAside;
    return text(data);
}

std::string progressJson(const JobRow& job, const FrameRow& frame) {
    return text({{"job", job.id},
                 {"frame", frame.frame},
                 {"passes", job.passes},
                 {"passesMerged", job.passesMerged},
                 {"fraction", job.fractionDone()},
                 {"samplesMerged", frame.samplesMerged},
                 {"relativeError", maybe(frame.relativeError)},
                 {"deviceSeconds", job.deviceSeconds},
                 {"revision", frame.revision}});
}

std::string frameStateJson(const FrameRow& frame) {
    return text(
        {{"frame", frame.frame}, {"state", toString(frame.state)}, {"deviceSeconds", frame.deviceSeconds}});
}

std::string leaseJson(const std::string& worker, LeaseState state) {
    return text({{"worker", worker}, {"state", toString(state)}});
}

std::string workerJson(const WorkerRow& worker) {
    return text(
        {{"worker", worker.hello.worker}, {"state", toString(worker.state)}, {"reason", worker.reason}});
}

}  // namespace tilefarm
