#pragma once

#include "server/study/request.h"
#include "shared/job/json_reader.h"

namespace tilefarm {

/// The base with some of its knobs turned.
struct StudyVariant {
    std::string label;        // "base", "settings.clampIndirect = 10"
    nlohmann::json settings;  // path -> value, of the knobs that are turned
    nlohmann::json job;       // canonical, but for its seed, samples and name
};

/// A variant at a number of samples per pixel.
struct StudyCell {
    uint32_t variant = 0;
    uint32_t samples = 0;
};

/// The jobs that a study is made of: a pure function of its request.
class StudyPlan {
public:
    /// Throws Error(invalidArgument) whose faults name the values ("/knobs/0/values/1") that no job can have.
    explicit StudyPlan(StudyRequest request);

    const StudyRequest& request() const { return request_; }
    const std::vector<StudyVariant>& variants() const { return variants_; }  // the base first
    const std::vector<StudyCell>& cells() const { return cells_; }           // few samples first
    JobSpec job(const StudyCell& cell, uint32_t seed) const;                 // of [0, seeds)
    JobSpec reference() const;
    /// The same for all studies with the same reference, whatever of its job changes no bit.
    std::string referenceKey() const;

private:
    void addVariant(const std::vector<std::pair<size_t, size_t>>& choice);
    void addGrid();
    void requireJob(const StudyVariant& variant, const std::string& pointer);
    void requireFewJobs();

    StudyRequest request_;
    nlohmann::json base_;
    std::vector<StudyVariant> variants_;
    std::vector<StudyCell> cells_;
    Faults faults_;
};

/// The idempotency key of a job of a study.
std::string studyJobKey(const std::string& study, size_t cell, uint32_t seed);

}  // namespace tilefarm
