#include "shared/job/wire.h"

#include <fmt/format.h>

#include "shared/job/fields.h"
#include "shared/job/pass_schedule.h"
#include "shared/job/rules.h"

namespace tilefarm {

namespace {

using nlohmann::json;

template <typename T>
T readAll(const json& source, const char* what, JsonReader::Unknown unknown = JsonReader::Unknown::fault) {
    Faults faults;
    T value;
    JsonReader::read(source, "", faults, value, unknown);
    if constexpr (std::same_as<T, JobSpec>) {
        settleFrames(value.frames, faults);
        settleStop(value.stop, faults);
        checkJob(value, faults);
    }
    faults.throwIfAny(ErrorCode::invalidArgument, what);
    return value;
}

}  // namespace

JobSpec jobFromJson(const json& source) {
    return readAll<JobSpec>(source, "the job");
}
StopCondition stopFromJson(const json& source) {
    return readAll<StopCondition>(source, "the stop condition");
}
json toJson(const JobSpec& spec) {
    return JsonWriter::write(spec);
}
json jobSchema() {
    return JsonSchema::schemaOf(JobSpec{});
}

Lease leaseFromJson(const json& source) {
    Lease lease = readAll<Lease>(source, "the lease");
    // The job within a lease obeys the same rules as one that is submitted, paths above all.
    lease.spec = jobFromJson(source.at("spec"));
    if (lease.spec.image.width == 0 || lease.spec.image.height == 0)
        throw Error(ErrorCode::invalidArgument, "the lease: its image has no size");
    const uint32_t tiles = TileGrid(lease.spec.image).count();
    for (const LeasedPass& pass : lease.passes)
        if (pass.tile >= tiles)
            throw Error(ErrorCode::invalidArgument,
                        fmt::format("the lease: tile {} of an image of {} tiles", pass.tile, tiles));
    return lease;
}
json toJson(const Lease& lease) {
    return JsonWriter::write(lease);
}

// A worker of another version may say more; it is to hear 426, not that a member is unknown.
WorkerHello helloFromJson(const json& source) {
    return readAll<WorkerHello>(source, "the worker's hello", JsonReader::Unknown::ignore);
}
json toJson(const WorkerHello& hello) {
    return JsonWriter::write(hello);
}

ResultReceipt receiptFromJson(const json& source) {
    return readAll<ResultReceipt>(source, "the receipt");
}
json toJson(const ResultReceipt& receipt) {
    return JsonWriter::write(receipt);
}

}  // namespace tilefarm
