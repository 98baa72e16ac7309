#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "server/store/job_store.h"

namespace tilefarm {

/// Whether a job's view holds all that was submitted, or of its scene's files the entry alone: a list of jobs
/// with thousands of files each would be hundreds of megabytes.
enum class SpecView { whole, outline };

/// The API's JSON of rows.
nlohmann::json jobView(const ConstTables& t, const JobRow& job, SpecView specView);
nlohmann::json frameView(const FrameRow& frame, const StopCondition& stop);
nlohmann::json eventView(const EventRow& event);
nlohmann::json workerView(const WorkerRow& worker, double samplesPerSecond);

/// RFC 3339 in UTC with milliseconds.
std::string rfc3339(TimePoint time);
/// JSON text; bytes that are no UTF-8 (a worker's message) are replaced.
std::string dump(const nlohmann::json& json);

/// The job's row, or Error(notFound).
JobRow requireJob(const ConstTables& t, const std::string& id);
int32_t frameNumber(const std::string& text);

}  // namespace tilefarm
