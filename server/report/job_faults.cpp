#include "server/report/job_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

namespace tilefarm {

using nlohmann::json;

namespace {

json samplesOf(const JobRow& job) {
    if (job.faultSamples.empty()) return json::array();
    const json seed = json::parse(job.specJson).at("settings").at("seed");
    json list = json::array();
    for (const std::string& line : job.faultSamples) {
        std::istringstream words(line);
        int32_t frame = 0;
        uint32_t x = 0, y = 0, sample = 0;
        words >> frame >> x >> y >> sample;
        list.push_back({{"frame", frame}, {"x", x}, {"y", y}, {"sample", sample}, {"seed", seed}});
    }
    return list;
}

}  // namespace

bool isFlagged(const JobRow& job) {
    return job.droppedSamples > 0 || !job.faultSamples.empty();
}

std::vector<std::string> faultsOf(const JobRow& job) {
    std::vector<std::string> faults = job.faults;
    if (isFlagged(job))
        faults.push_back(
            fmt::format("{} samples were NaN or infinite and were left out; see numerics.samples",
                        std::max<uint64_t>(job.droppedSamples, job.faultSamples.size())));
    return faults;
}

json numericsOf(const JobRow& job) {
    const double paths = static_cast<double>(job.pixelSamplesMerged);
    const auto perPath = [&](double sum) { return paths > 0 ? sum / paths : 0; };
    const double light = job.keptLuminance + job.clampedLuminance;
    return {{"droppedSamples", job.droppedSamples},
            {"rejectedPaths", job.rejectedPaths},
            {"truncatedPaths", job.truncatedPaths},
            {"truncatedShare", perPath(static_cast<double>(job.truncatedPaths))},
            {"truncatedThroughput", perPath(job.truncatedThroughput)},
            {"clampedSamples", job.clampedSamples},
            {"clampedLuminance", perPath(job.clampedLuminance)},
            {"clampedPercent", light > 0 ? 100 * job.clampedLuminance / light : 0},
            {"samples", samplesOf(job)}};
}

}  // namespace tilefarm
