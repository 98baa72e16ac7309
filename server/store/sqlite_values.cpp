#include "server/store/sqlite_values.h"

#include <cstring>

#include "server/store/text_list.h"

namespace tilefarm {
namespace {

// A pass in a blob: tile, first sample, samples.
using PackedPass = uint32_t[3];

}  // namespace

void readValue(const SQLite::Column& from, double& to) {
    to = from.getDouble();
}
void readValue(const SQLite::Column& from, std::string& to) {
    to = from.getString();
}
void readValue(const SQLite::Column& from, TimePoint& to) {
    to = TimePoint{Milliseconds{from.getInt64()}};
}
void readValue(const SQLite::Column& from, JobState& to) {
    to = jobStateFrom(from.getString());
}
void readValue(const SQLite::Column& from, FrameState& to) {
    to = frameStateFrom(from.getString());
}
void readValue(const SQLite::Column& from, PassState& to) {
    to = passStateFrom(from.getString());
}
void readValue(const SQLite::Column& from, LeaseState& to) {
    to = leaseStateFrom(from.getString());
}
void readValue(const SQLite::Column& from, WorkerState& to) {
    to = workerStateFrom(from.getString());
}
void readValue(const SQLite::Column& from, Loss& to) {
    to = lossFrom(from.getString());
}
void readValue(const SQLite::Column& from, StopReason& to) {
    to = stopReasonFrom(from.getString());
}
void readValue(const SQLite::Column& from, StudyState& to) {
    to = studyStateFrom(from.getString());
}
void readValue(const SQLite::Column& from, std::vector<std::string>& to) {
    to = splitLines(from.getString());
}
void readValue(const SQLite::Column& from, ErrorTail& to) {
    to = ErrorTail::parse(from.getString());
}

void readValue(const SQLite::Column& from, std::vector<LeasedPass>& to) {
    const std::string bytes = from.getString();
    to.resize(bytes.size() / sizeof(PackedPass));
    const char* at = bytes.data();
    for (LeasedPass& pass : to) {
        PackedPass values;
        std::memcpy(values, at, sizeof values);
        at += sizeof values;
        pass = {values[0], {values[1], values[2]}};
    }
}

void bindValue(SQLite::Statement& to, int parameter, double value) {
    to.bind(parameter, value);
}
void bindValue(SQLite::Statement& to, int parameter, const std::string& value) {
    to.bind(parameter, value);
}
void bindValue(SQLite::Statement& to, int parameter, TimePoint value) {
    to.bind(parameter, int64_t{value.time_since_epoch().count()});
}
void bindValue(SQLite::Statement& to, int parameter, const std::vector<std::string>& value) {
    to.bind(parameter, joinLines(value));
}
void bindValue(SQLite::Statement& to, int parameter, const ErrorTail& value) {
    bindValue(to, parameter, value.text());
}

void bindValue(SQLite::Statement& to, int parameter, const std::vector<LeasedPass>& value) {
    std::string bytes;  // never a null pointer, which would bind NULL
    for (const LeasedPass& pass : value) {
        const PackedPass values{pass.tile, pass.samples.first, pass.samples.count};
        bytes.append(reinterpret_cast<const char*>(values), sizeof values);
    }
    to.bind(parameter, static_cast<const void*>(bytes.data()), static_cast<int>(bytes.size()));
}

}  // namespace tilefarm
