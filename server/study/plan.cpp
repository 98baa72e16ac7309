#include "server/study/plan.h"

#include <algorithm>
#include <array>

#include "shared/digest/digest.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

// What the study itself decides, or what makes no difference to a picture.
constexpr std::array kNotKnobs{"name",          "frames",      "stop",       "priority",
                               "settings.seed", "scene.files", "scene.entry"};

bool isKnob(const std::string& path) {
    return std::none_of(kNotKnobs.begin(), kNotKnobs.end(), [&](const std::string& taken) {
        return path == taken || path.starts_with(taken + ".") || taken.starts_with(path + ".");
    });
}

json::json_pointer pointerOf(const std::string& path) {
    std::string pointer;
    for (size_t from = 0; from <= path.size();) {
        const size_t end = std::min(path.find('.', from), path.size());
        pointer += "/" + pointerToken(path.substr(from, end - from));
        from = end + 1;
    }
    return json::json_pointer(pointer);
}

void turn(json& job, const StudyKnob& knob, const json& value) {
    json& member = job[pointerOf(knob.path)];
    if (value.is_object() && member.is_object())
        member.merge_patch(value);
    else
        member = value;
}

std::string words(const json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace

StudyPlan::StudyPlan(StudyRequest request) : request_(std::move(request)), base_(toJson(request_.job)) {
    if (uint64_t{request_.job.image.width} * request_.job.image.height > kMostStudyPixels)
        faults_.add("/job/image", "a study's pictures have at most 2097152 pixels");
    addVariant({});
    for (size_t k = 0; k < request_.knobs.size(); ++k) {
        if (!isKnob(request_.knobs[k].path))
            faults_.add("/knobs/" + std::to_string(k) + "/path",
                        "'" + request_.knobs[k].path + "' is no knob: the study decides it");
    }
    if (faults_.none()) {
        if (request_.grid) addGrid();
        for (size_t k = 0; k < request_.knobs.size() && !request_.grid; ++k)
            for (size_t v = 0; v < request_.knobs[k].values.size(); ++v) addVariant({{k, v}});
    }
    if (faults_.none()) requireFewJobs();
    faults_.throwIfAny(ErrorCode::invalidArgument, "the study");
    for (const uint32_t samples : request_.samples)
        for (uint32_t variant = 0; variant < variants_.size(); ++variant)
            cells_.push_back({variant, samples});
}

// The values' numbers count up like a number's digits.
void StudyPlan::addGrid() {
    size_t count = 1;
    for (const StudyKnob& knob :
         request_.knobs)  // no further than it may go: the product of all may overflow
        if (count <= kMostStudyJobs) count *= knob.values.size();
    if (count * request_.samples.size() * request_.seeds > kMostStudyJobs)
        return faults_.add("/grid", "the grid makes more than " + std::to_string(kMostStudyJobs) + " jobs");
    for (size_t i = 0; i < count; ++i) {
        std::vector<std::pair<size_t, size_t>> choice;
        size_t rest = i;
        for (size_t k = 0; k < request_.knobs.size(); ++k) {
            choice.emplace_back(k, rest % request_.knobs[k].values.size());
            rest /= request_.knobs[k].values.size();
        }
        addVariant(choice);
    }
}

// A value that the base has already makes no variant.
void StudyPlan::addVariant(const std::vector<std::pair<size_t, size_t>>& choice) {
    StudyVariant variant{.label = choice.empty() ? "base" : "", .settings = json::object(), .job = base_};
    std::string pointer = "/knobs";
    try {
        for (const auto& [k, v] : choice) {
            const StudyKnob& knob = request_.knobs[k];
            pointer = "/knobs/" + std::to_string(k) + "/values/" + std::to_string(v);
            const json before = variant.job;
            turn(variant.job, knob, knob.values[v]);
            requireJob(variant, pointer);
            if (variant.job == before) continue;
            variant.settings[knob.path] = knob.values[v];
            variant.label += (variant.label.empty() ? "" : ", ") + knob.path + " = " + words(knob.values[v]);
        }
    } catch (const json::exception&) {
        return faults_.add(pointer, "the job has no member of this path");
    }
    const auto known = std::any_of(variants_.begin(), variants_.end(),
                                   [&](const StudyVariant& other) { return other.job == variant.job; });
    if (!known) variants_.push_back(std::move(variant));
}

void StudyPlan::requireJob(const StudyVariant& variant, const std::string& pointer) {
    try {
        const JobSpec spec = jobFromJson(variant.job);
        if (uint64_t{spec.image.width} * spec.image.height > kMostStudyPixels)
            faults_.add(pointer, "a study's pictures have at most 2097152 pixels");
    } catch (const Error& error) {
        for (const Fault& fault : error.faults) faults_.add(pointer, fault.pointer + " " + fault.message);
        if (error.faults.empty()) faults_.add(pointer, error.what());
    }
}

void StudyPlan::requireFewJobs() {
    if (variants_.size() * request_.samples.size() * request_.seeds > kMostStudyJobs)
        faults_.add("/knobs", "the study makes more than " + std::to_string(kMostStudyJobs) + " jobs");
}

JobSpec StudyPlan::job(const StudyCell& cell, uint32_t seed) const {
    const StudyVariant& variant = variants_[cell.variant];
    json job = variant.job;
    job["settings"]["seed"] = request_.job.settings.seed + seed;
    job["stop"] = {{"samples", cell.samples}};
    job["priority"] = request_.priority;
    JobSpec spec = jobFromJson(job);
    spec.name = (request_.name + ": " + variant.label).substr(0, 200);
    return spec;
}

JobSpec StudyPlan::reference() const {
    JobSpec spec = request_.job;
    spec.name = (request_.name + ": reference").substr(0, 200);
    spec.settings.seed = request_.referenceSeed;
    spec.stop = {};
    spec.stop.samples = request_.referenceSamples;
    spec.output = {};
    spec.priority = request_.priority;
    return spec;
}

std::string StudyPlan::referenceKey() const {
    json job = toJson(reference());
    for (const char* member : {"name", "priority"}) job.erase(member);
    job["image"].erase("tileSize");
    return "study-reference:" + sha256Hex(job.dump());
}

std::string studyJobKey(const std::string& study, size_t cell, uint32_t seed) {
    return "study:" + study + ":" + std::to_string(cell) + ":" + std::to_string(seed);
}

}  // namespace tilefarm
