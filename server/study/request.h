#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "shared/job/job.h"

namespace tilefarm {

/// A member of a job's JSON, as "settings.clampIndirect", and what to set it to. A value that is an object
/// replaces the members that it has: {"width": 320, "height": 180} of "image".
struct StudyKnob {
    std::string path;
    std::vector<nlohmann::json> values;
};

/// What to compare: a job, as it is and with its knobs turned, with several seeds each, against a reference.
struct StudyRequest {
    std::string name;
    JobSpec job;  // the base; of its stop and seed only what follows from them below
    std::vector<StudyKnob> knobs;
    bool grid = false;              // all combinations of the values; else one knob at a time
    std::vector<uint32_t> samples;  // per pixel, ascending
    uint32_t seeds = 5;             // the base's and those after it
    uint32_t referenceSamples = 0;
    uint32_t referenceSeed = 0;
    int32_t priority = 10;
};

inline constexpr uint32_t kMostStudyPixels = 1u << 21;  // of a picture: two are in memory at a time
inline constexpr size_t kMostStudyJobs = 5000;

/// Throws Error(invalidArgument) whose `faults` lists every fault with its JSON pointer. Left out: three
/// sample counts, to a sixteenth of the job's; 16 times its samples for the reference, which gets a seed far
/// from those of the study.
StudyRequest studyFromJson(const nlohmann::json& json);
/// Canonical: every member.
nlohmann::json toJson(const StudyRequest& request);

}  // namespace tilefarm
