#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "server/store/job_store.h"
#include "shared/film/forecast.h"
#include "shared/job/job.h"

namespace tilefarm {

/// Of the job's frame that is farthest: what is known of it; nothing before its error and its pace are, which
/// takes three complete levels.
std::optional<FrameOutlook> outlookOf(const ConstTables& t, const FrameRow& frame, const JobSpec& spec);

/// What a frame will take in all by its own stop condition: until its error target, or where that is beyond
/// its samples until these; at most its device seconds. A limit of wall seconds is not looked at.
Forecast forecastOf(const FrameOutlook& frame, const StopCondition& stop);

/// forecast: the job's own end, and targets: what each error target would take. Of the frame that is
/// farthest, and times so many frames; null where it is not known yet. workers: those that took part,
/// with their pace.
nlohmann::json forecastView(const ConstTables& t, const JobRow& job, const JobSpec& spec,
                            const std::vector<double>& targets, uint32_t frames);

/// What the frame was expected to take when a tenth of it was spent, and what it has taken; null where that was
/// never known.
nlohmann::json keptForecast(const FrameRow& frame);

/// Error targets that a forecast tells where none are asked for.
inline const std::vector<double> kUsualTargets{0.05, 0.02, 0.01, 0.005};

}  // namespace tilefarm
