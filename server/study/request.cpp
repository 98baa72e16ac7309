#include "server/study/request.h"

#include <algorithm>
#include <limits>
#include <set>

#include "shared/error/error.h"
#include "shared/job/json_reader.h"
#include "shared/job/wire.h"

namespace tilefarm {
namespace {

using nlohmann::json;

constexpr uint32_t kMostSeeds = 64, kMostSamples = 1u << 24;
constexpr size_t kMostKnobs = 32, kMostValues = 32, kMostSampleCounts = 8;
constexpr uint32_t kReferenceSeedStep = 1'000'000;
constexpr uint32_t kReferenceTimesSamples = 16;

// A study's members, each read with its fault noted under its pointer.
class Reader {
public:
    explicit Reader(const json& from) : from_(from) {
        if (!from.is_object()) fault("", "must be an object");
    }

    void allow(const json& object, const std::string& pointer, const std::set<std::string>& members) {
        if (!object.is_object()) return;
        for (const auto& [name, value] : object.items())
            if (!members.contains(name)) fault(pointer + "/" + pointerToken(name), "unknown member");
    }
    const json* member(const char* name) const {
        if (!from_.is_object()) return nullptr;
        const auto at = from_.find(name);
        return at == from_.end() ? nullptr : &*at;
    }
    template <typename Number>
    void integer(const json& object, const std::string& pointer, const char* name, int64_t least,
                 int64_t most, Number& into) {
        if (!object.is_object() || !object.contains(name)) return;
        number(object.at(name), pointer + "/" + name, least, most, into);
    }
    template <typename Number>
    void number(const json& value, const std::string& pointer, int64_t least, int64_t most, Number& into) {
        const bool fits = value.is_number_integer() && value >= least && value <= most;
        if (fits)
            into = value.get<Number>();
        else
            fault(pointer,
                  "must be an integer from " + std::to_string(least) + " to " + std::to_string(most));
    }
    void fault(std::string pointer, std::string message) {
        faults_.add(std::move(pointer), std::move(message));
    }
    Faults& faults() { return faults_; }

private:
    const json& from_;
    Faults faults_;
};

void readJob(Reader& reader, StudyRequest& request) {
    const json* job = reader.member("job");
    if (!job) return reader.fault("/job", "is missing");
    try {
        request.job = jobFromJson(*job);
    } catch (const Error& error) {
        reader.faults().addBelow("/job", error);
    }
    if (request.job.frames.count != 1) reader.fault("/job/frames", "a study is of one frame");
}

void readKnob(Reader& reader, const json& from, const std::string& pointer, StudyRequest& request) {
    if (!from.is_object()) return reader.fault(pointer, "must be an object");
    reader.allow(from, pointer, {"path", "values"});
    const json path = from.value("path", json()), values = from.value("values", json());
    if (!path.is_string() || path.get<std::string>().empty())
        return reader.fault(pointer + "/path", "must name a member of the job, as settings.maxBounces");
    if (!values.is_array() || values.empty() || values.size() > kMostValues)
        return reader.fault(pointer + "/values",
                            "must be a list of 1 to " + std::to_string(kMostValues) + " values");
    request.knobs.push_back({path.get<std::string>(), values.get<std::vector<json>>()});
}

void readKnobs(Reader& reader, StudyRequest& request) {
    const json* knobs = reader.member("knobs");
    if (!knobs || !knobs->is_array() || knobs->empty() || knobs->size() > kMostKnobs)
        return reader.fault("/knobs", "must be a list of 1 to " + std::to_string(kMostKnobs) + " knobs");
    for (size_t i = 0; i < knobs->size(); ++i)
        readKnob(reader, (*knobs)[i], "/knobs/" + std::to_string(i), request);
}

void readSamples(Reader& reader, StudyRequest& request) {
    const json* list = reader.member("samples");
    if (!list) {
        const uint32_t most = request.job.stop.samples;
        for (const uint32_t count : {most / 16, most / 4, most})
            if (count > 0) request.samples.push_back(count);
    } else if (!list->is_array() || list->empty() || list->size() > kMostSampleCounts) {
        return reader.fault("/samples",
                            "must be a list of 1 to " + std::to_string(kMostSampleCounts) + " counts");
    } else {
        request.samples.resize(list->size());
        for (size_t i = 0; i < list->size(); ++i)
            reader.number((*list)[i], "/samples/" + std::to_string(i), 1, kMostSamples, request.samples[i]);
    }
    std::sort(request.samples.begin(), request.samples.end());
    request.samples.erase(std::unique(request.samples.begin(), request.samples.end()), request.samples.end());
}

void readReference(Reader& reader, StudyRequest& request) {
    const uint64_t samples =
        uint64_t{request.samples.empty() ? 1 : request.samples.back()} * kReferenceTimesSamples;
    request.referenceSamples = static_cast<uint32_t>(std::min<uint64_t>(samples, kMostSamples));
    const uint32_t seed = request.job.settings.seed;
    request.referenceSeed = seed + kReferenceSeedStep;
    if (const json* from = reader.member("reference")) {
        if (!from->is_object()) return reader.fault("/reference", "must be an object");
        reader.allow(*from, "/reference", {"samples", "seed"});
        reader.integer(*from, "/reference", "samples", 1, kMostSamples, request.referenceSamples);
        reader.integer(*from, "/reference", "seed", 0, std::numeric_limits<uint32_t>::max(),
                       request.referenceSeed);
    }
    if (request.referenceSeed - seed < request.seeds)
        reader.fault("/reference/seed",
                     "is one of the study's own seeds: the reference would not be independent");
}

}  // namespace

StudyRequest studyFromJson(const json& from) {
    Reader reader(from);
    reader.allow(from, "", {"name", "job", "knobs", "grid", "samples", "seeds", "reference", "priority"});
    StudyRequest request;
    readJob(reader, request);
    readKnobs(reader, request);
    reader.integer(from, "", "seeds", 2, kMostSeeds, request.seeds);
    reader.integer(from, "", "priority", 0, 100, request.priority);
    readSamples(reader, request);
    readReference(reader, request);
    if (const json* grid = reader.member("grid")) {
        if (!grid->is_boolean()) reader.fault("/grid", "must be true or false");
        request.grid = *grid == true;
    }
    request.name = request.job.name;
    if (const json* name = reader.member("name")) {
        if (!name->is_string() || name->get<std::string>().size() > 200)
            reader.fault("/name", "must be a text of at most 200 bytes");
        else
            request.name = *name;
    }
    reader.faults().throwIfAny(ErrorCode::invalidArgument, "the study");
    return request;
}

json toJson(const StudyRequest& request) {
    json knobs = json::array();
    for (const StudyKnob& knob : request.knobs)
        knobs.push_back({{"path", knob.path}, {"values", knob.values}});
    return {{"name", request.name},
            {"job", toJson(request.job)},
            {"knobs", knobs},
            {"grid", request.grid},
            {"samples", request.samples},
            {"seeds", request.seeds},
            {"reference", {{"samples", request.referenceSamples}, {"seed", request.referenceSeed}}},
            {"priority", request.priority}};
}

}  // namespace tilefarm
