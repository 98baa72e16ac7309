#include "server/report/job_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "shared/film/notices.h"

namespace tilefarm {

using nlohmann::json;

namespace {

json samplesOf(const JobRow& job) {
    if (job.faultSamples.empty()) return json::array();
    const json seed = json::parse(job.outlineJson).at("settings").at("seed");
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

uint64_t droppedOf(const JobRow& job) {
    return std::max<uint64_t>(job.droppedSamples, job.faultSamples.size());
}

}  // namespace

bool isFlagged(const JobRow& job) {
    return droppedOf(job) > 0 || job.rejectedPaths > 0;
}

std::vector<std::string> faultsOf(const JobRow& job) {
    std::vector<std::string> faults = job.faults;
    if (!job.setAside.empty()) faults.push_back(job.setAside);
    if (const uint64_t dropped = droppedOf(job))
        faults.push_back(
            fmt::format("{} NaN or infinite and dropped; numerics.samples names them",
                        dropped == 1 ? "1 sample was" : fmt::format("{} samples were", dropped)));
    if (const uint64_t rejected = job.rejectedPaths)
        faults.push_back(fmt::format(
            "{} rejected (a sampled direction of probability 0, or too many nested solids): their light "
            "is missing",
            rejected == 1 ? "1 path was" : fmt::format("{} paths were", rejected)));
    return faults;
}

std::vector<std::string> noticesOf(const JobRow& job) {
    PassFaults faults;
    faults.truncatedPaths = job.truncatedPaths;
    faults.truncatedThroughput = job.truncatedThroughput;
    faults.lightsBehindGlass = job.lightsBehindGlass;
    return noticesOf(faults, job.pixelSamplesMerged);
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
            {"lightsBehindGlass", job.lightsBehindGlass},
            {"samples", samplesOf(job)}};
}

}  // namespace tilefarm
