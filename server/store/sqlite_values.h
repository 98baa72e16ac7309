#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <concepts>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "server/store/rows.h"

namespace tilefarm {

/// How SQLite keeps the types of the rows: one `readValue` and one `bindValue` each. A state is its word, a
/// time the milliseconds since the Unix epoch, a list of texts a line each, as is a tail of errors, passes a
/// blob, nothing NULL.

template <std::integral Number>
void readValue(const SQLite::Column& from, Number& to) {
    to = static_cast<Number>(from.getInt64());
}
void readValue(const SQLite::Column& from, double& to);
void readValue(const SQLite::Column& from, std::string& to);
void readValue(const SQLite::Column& from, TimePoint& to);
void readValue(const SQLite::Column& from, JobState& to);
void readValue(const SQLite::Column& from, FrameState& to);
void readValue(const SQLite::Column& from, PassState& to);
void readValue(const SQLite::Column& from, LeaseState& to);
void readValue(const SQLite::Column& from, WorkerState& to);
void readValue(const SQLite::Column& from, Loss& to);
void readValue(const SQLite::Column& from, StopReason& to);
void readValue(const SQLite::Column& from, StudyState& to);
void readValue(const SQLite::Column& from, std::vector<std::string>& to);
void readValue(const SQLite::Column& from, std::vector<LeasedPass>& to);
void readValue(const SQLite::Column& from, ErrorTail& to);
template <typename Value>
void readValue(const SQLite::Column& from, std::optional<Value>& to) {
    to.reset();
    if (!from.isNull()) readValue(from, to.emplace());
}

template <std::integral Number>
void bindValue(SQLite::Statement& to, int parameter, Number value) {
    to.bind(parameter, static_cast<int64_t>(value));
}
void bindValue(SQLite::Statement& to, int parameter, double value);
void bindValue(SQLite::Statement& to, int parameter, const std::string& value);
void bindValue(SQLite::Statement& to, int parameter, TimePoint value);
template <typename State>
requires std::is_enum_v<State>
void bindValue(SQLite::Statement& to, int parameter, State value) {
    bindValue(to, parameter, std::string(toString(value)));
}
void bindValue(SQLite::Statement& to, int parameter, const std::vector<std::string>& value);
void bindValue(SQLite::Statement& to, int parameter, const std::vector<LeasedPass>& value);
void bindValue(SQLite::Statement& to, int parameter, const ErrorTail& value);
template <typename Value>
void bindValue(SQLite::Statement& to, int parameter, const std::optional<Value>& value) {
    value ? bindValue(to, parameter, *value) : to.bind(parameter);
}

}  // namespace tilefarm
