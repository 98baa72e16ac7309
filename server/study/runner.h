#pragma once

#include <map>
#include <memory>

#include "server/film/frame_images.h"
#include "server/queue/scheduler.h"
#include "server/study/plan.h"

namespace tilefarm {

/// A study as far as it has come.
struct StudyProgress {
    size_t jobs = 0, jobsDone = 0;  // the reference among them
    size_t cells = 0, cellsMeasured = 0;
    std::string reference;  // id of its job; empty until it is made
};

/// Turns studies into jobs and their pictures into figures. What it does next follows from what the store
/// holds, and its jobs have idempotency keys: it may be killed between any two steps.
class StudyRunner {
public:
    StudyRunner(JobStore& store, Scheduler& scheduler, FrameImages& images, const Clock& clock);

    // Any thread may call.
    StudyRow create(const StudyRequest& request);
    /// Its jobs are canceled by a later step. Throws Error(notFound), or Error(conflict) if it has ended.
    StudyRow cancel(const std::string& id);
    static StudyProgress progress(const ConstTables& t, const StudyRow& row, const StudyPlan& plan);

    /// Does what there is to do for each open study, one comparison of pictures at most; whether there is
    /// more at once. By one thread at a time. A fault of a study ends that study alone.
    bool step();

private:
    struct Jobs;
    bool advance(const StudyRow& row);
    void cancelJobs(const StudyRow& row);
    void submitJobs(const StudyRow& row, const StudyPlan& plan, const Jobs& jobs);
    bool measureNext(const StudyRow& row, const StudyPlan& plan, const Jobs& jobs);
    void end(const StudyRow& row, StudyState state, const std::string& fault);
    std::shared_ptr<const StudyPlan> planOf(const StudyRow& row);

    JobStore& store_;
    Scheduler& scheduler_;
    FrameImages& images_;
    const Clock& clock_;
    std::pair<std::string, std::shared_ptr<const StudyPlan>> lastPlan_;  // by the study's id
};

}  // namespace tilefarm
