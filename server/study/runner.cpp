#include "server/study/runner.h"

#include <algorithm>
#include <set>

#include "server/store/file.h"
#include "server/study/measure.h"
#include "server/study/pictures.h"
#include "shared/error/error.h"
#include "shared/image/exr.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr size_t kMostOpenJobs = 64;      // of a study: few enough for lists, enough for any farm
constexpr const char* kDigest = "study";  // what a key stands for is in the key

// A reference that somebody ended before this study began is made again, under the next key.
std::string referenceKeyOf(const ConstTables& t, const StudyRow& row, const StudyPlan& plan) {
    for (int attempt = 0;; ++attempt) {
        const std::string key = plan.referenceKey() + ":" + std::to_string(attempt);
        const auto job = t.jobs.findByIdempotencyKey(key);
        const bool lost = job && isFinal(job->state) && job->state != JobState::completed;
        if (!lost || job->finished > row.created) return key;
    }
}

FloatImage pictureOf(FrameImages& images, const JobRow& job, const JobSpec& spec) {
    const ImageFile file = images.exr(job.id, spec.frames.first);
    std::vector<std::byte> bytes(file.bytes);
    file.file->readAt(0, bytes);
    return studiedPicture(readExr(bytes, "the picture of job " + job.id), spec.output.denoise);
}

}  // namespace

// Of a study: those that exist, in the order in which they are wanted.
struct StudyRunner::Jobs {
    std::string referenceKey;
    std::optional<JobRow> reference;
    std::set<uint32_t> measured;
    std::map<std::pair<size_t, uint32_t>, JobRow> ofCells;  // by cell and seed; of those not yet measured

    static Jobs of(const ConstTables& t, const StudyRow& row, const StudyPlan& plan) {
        Jobs jobs;
        jobs.referenceKey = referenceKeyOf(t, row, plan);
        jobs.reference = t.jobs.findByIdempotencyKey(jobs.referenceKey);
        for (const StudyCellRow& cell : t.studies.cells(row.key)) jobs.measured.insert(cell.cell);
        for (size_t cell = 0; cell < plan.cells().size(); ++cell) {
            if (jobs.measured.contains(static_cast<uint32_t>(cell))) continue;
            for (uint32_t seed = 0; seed < plan.request().seeds; ++seed) {
                const auto job = t.jobs.findByIdempotencyKey(studyJobKey(row.id, cell, seed));
                if (!job) return jobs;  // they are made in order
                jobs.ofCells.emplace(std::pair(cell, seed), *job);
            }
        }
        return jobs;
    }
    // The first that ended without a picture.
    const JobRow* lost() const {
        const auto isLost = [](const JobRow& job) {
            return isFinal(job.state) && job.state != JobState::completed;
        };
        if (reference && isLost(*reference)) return &*reference;
        const auto at =
            std::find_if(ofCells.begin(), ofCells.end(), [&](const auto& of) { return isLost(of.second); });
        return at == ofCells.end() ? nullptr : &at->second;
    }
    size_t open() const {
        return static_cast<size_t>(std::count_if(ofCells.begin(), ofCells.end(),
                                                 [](const auto& of) { return !isFinal(of.second.state); }));
    }
    bool complete(size_t cell, uint32_t seeds) const {
        for (uint32_t seed = 0; seed < seeds; ++seed) {
            const auto at = ofCells.find({cell, seed});
            if (at == ofCells.end() || at->second.state != JobState::completed) return false;
        }
        return true;
    }
};

StudyRunner::StudyRunner(JobStore& store, Scheduler& scheduler, FrameImages& images, const Clock& clock)
    : store_(store), scheduler_(scheduler), images_(images), clock_(clock) {}

StudyRow StudyRunner::create(const StudyRequest& request) {
    StudyRow row{.id = "s" + randomHex(10),
                 .requestJson = toJson(request).dump(),
                 .created = clock_.now(),
                 .finished = {},
                 .fault = {}};
    store_.write([&](Tables& t) { row.key = t.studies.insert(row); });
    return row;
}

StudyRow StudyRunner::cancel(const std::string& id) {
    StudyRow row;
    store_.write([&](Tables& t) {
        const auto found = t.studies.find(id);
        if (!found) throw Error(ErrorCode::notFound, "there is no study '" + id + "'");
        row = *found;
        if (row.state == StudyState::canceled) return;
        if (row.state != StudyState::running)
            throw Error(ErrorCode::conflict, "study '" + id + "' is " + std::string(toString(row.state)));
        row.state = StudyState::canceled;
        t.studies.update(row);
    });
    return row;
}

StudyProgress StudyRunner::progress(const ConstTables& t, const StudyRow& row, const StudyPlan& plan) {
    const Jobs jobs = Jobs::of(t, row, plan);
    StudyProgress progress{.jobs = 1 + plan.cells().size() * plan.request().seeds,
                           .jobsDone = jobs.measured.size() * plan.request().seeds,
                           .cells = plan.cells().size(),
                           .cellsMeasured = jobs.measured.size(),
                           .reference = jobs.reference ? jobs.reference->id : ""};
    progress.jobsDone += jobs.reference && jobs.reference->state == JobState::completed;
    for (const auto& [place, job] : jobs.ofCells) progress.jobsDone += job.state == JobState::completed;
    return progress;
}

bool StudyRunner::step() {
    std::vector<StudyRow> open;
    store_.read([&](const ConstTables& t) { open = t.studies.open(); });
    bool more = false;
    for (const StudyRow& row : open) {
        try {
            more = advance(row) || more;
        } catch (const Error& fault) {
            if (fault.code == ErrorCode::outOfSpace || fault.code == ErrorCode::unavailable) throw;
            end(row, StudyState::failed, fault.what());
        }
    }
    return more;
}

std::shared_ptr<const StudyPlan> StudyRunner::planOf(const StudyRow& row) {
    if (lastPlan_.first != row.id)
        lastPlan_ = {row.id, std::make_shared<const StudyPlan>(studyFromJson(json::parse(row.requestJson)))};
    return lastPlan_.second;
}

bool StudyRunner::advance(const StudyRow& row) {
    if (row.state != StudyState::running) {
        cancelJobs(row);
        return false;
    }
    const auto plan = planOf(row);
    Jobs jobs;
    store_.read([&](const ConstTables& t) { jobs = Jobs::of(t, row, *plan); });
    if (const JobRow* lost = jobs.lost()) {
        end(row, StudyState::failed, "job '" + lost->id + "' is " + std::string(toString(lost->state)));
        return true;
    }
    submitJobs(row, *plan, jobs);
    if (jobs.measured.size() < plan->cells().size()) return measureNext(row, *plan, jobs);
    end(row, StudyState::completed, {});
    return true;
}

// The reference first: nothing can be measured before it is there.
void StudyRunner::submitJobs(const StudyRow& row, const StudyPlan& plan, const Jobs& jobs) {
    if (!jobs.reference) scheduler_.submit(plan.reference(), jobs.referenceKey, kDigest);
    size_t open = jobs.open();
    for (size_t cell = 0; cell < plan.cells().size(); ++cell) {
        if (jobs.measured.contains(static_cast<uint32_t>(cell))) continue;
        for (uint32_t seed = 0; seed < plan.request().seeds; ++seed) {
            if (jobs.ofCells.contains({cell, seed})) continue;
            if (open++ >= kMostOpenJobs) return;
            scheduler_.submit(plan.job(plan.cells()[cell], seed), studyJobKey(row.id, cell, seed), kDigest);
        }
    }
}

bool StudyRunner::measureNext(const StudyRow& row, const StudyPlan& plan, const Jobs& jobs) {
    if (!jobs.reference || jobs.reference->state != JobState::completed) return false;
    for (size_t cell = 0; cell < plan.cells().size(); ++cell) {
        if (jobs.measured.contains(static_cast<uint32_t>(cell)) || !jobs.complete(cell, plan.request().seeds))
            continue;
        const FloatImage reference = pictureOf(images_, *jobs.reference, plan.reference());
        std::vector<double> seconds;
        json ids = json::array();
        for (uint32_t seed = 0; seed < plan.request().seeds; ++seed) {
            const JobRow& job = jobs.ofCells.at({cell, seed});
            seconds.push_back(job.deviceSeconds);
            ids.push_back(job.id);
        }
        MeasuredCell measured = measureCell(reference, seconds, [&](size_t seed) {
            const auto number = static_cast<uint32_t>(seed);
            return resized(
                pictureOf(images_, jobs.ofCells.at({cell, number}), plan.job(plan.cells()[cell], number)),
                reference.width, reference.height);
        });
        measured.result["jobs"] = ids;
        if (cell == 0) measured.pictures["reference"] = pngUrl(reference, 280);
        store_.write([&](Tables& t) {
            t.studies.putCell(
                {row.key, static_cast<uint32_t>(cell), measured.result.dump(), measured.pictures.dump()});
        });
        return true;
    }
    return false;
}

void StudyRunner::end(const StudyRow& row, StudyState state, const std::string& fault) {
    store_.write([&](Tables& t) {
        StudyRow now = t.studies.find(row.id).value();
        if (now.state != StudyState::running) return;  // canceled meanwhile
        now.state = state;
        now.fault = fault;
        if (state == StudyState::completed) now.finished = clock_.now();
        t.studies.update(now);
    });
}

// Of a study that ended early. A reference may be another study's as well: it is left.
void StudyRunner::cancelJobs(const StudyRow& row) {
    std::vector<std::string> open;
    store_.read([&](const ConstTables& t) {
        const auto plan = planOf(row);
        for (const auto& [place, job] : Jobs::of(t, row, *plan).ofCells)
            if (!isFinal(job.state)) open.push_back(job.id);
        const auto reference = t.jobs.findByIdempotencyKey(referenceKeyOf(t, row, *plan));
        const auto studies = t.studies.open();
        const bool shared = std::any_of(studies.begin(), studies.end(), [&](const StudyRow& other) {
            return other.state == StudyState::running &&
                   StudyPlan(studyFromJson(json::parse(other.requestJson))).referenceKey() ==
                       plan->referenceKey();
        });
        if (reference && !isFinal(reference->state) && !shared) open.push_back(reference->id);
    });
    for (const std::string& id : open) scheduler_.cancel(id);
    store_.write([&](Tables& t) {
        StudyRow now = t.studies.find(row.id).value();
        now.finished = clock_.now();
        t.studies.update(now);
    });
}

}  // namespace tilefarm
