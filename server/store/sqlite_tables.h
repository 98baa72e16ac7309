#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <memory>
#include <unordered_map>

#include "server/store/job_store.h"

namespace tilefarm {

/// A prepared statement for the length of a scope. Parameters are bound in the order of the calls.
class Query {
public:
    explicit Query(SQLite::Statement& statement) : statement_(statement) {}
    ~Query() { statement_.tryReset(); }
    Query(const Query&) = delete;
    Query& operator=(const Query&) = delete;

    template <typename... Values>
    Query& with(const Values&... values) {
        (bind(values), ...);
        return *this;
    }
    bool next() { return statement_.executeStep(); }
    /// For a statement without rows; how many it changed.
    uint64_t run() { return static_cast<uint64_t>(statement_.exec()); }

    int64_t integer(int column) const { return statement_.getColumn(column).getInt64(); }
    template <typename Number>
    Number number(int column) const {
        return static_cast<Number>(integer(column));
    }
    double real(int column) const { return statement_.getColumn(column).getDouble(); }
    std::string text(int column) const { return statement_.getColumn(column).getString(); }
    bool null(int column) const { return statement_.getColumn(column).isNull(); }
    TimePoint time(int column) const { return TimePoint{Milliseconds{integer(column)}}; }
    std::optional<TimePoint> maybeTime(int column) const {
        return null(column) ? std::nullopt : std::optional(time(column));
    }
    std::optional<double> maybeReal(int column) const {
        return null(column) ? std::nullopt : std::optional(real(column));
    }

private:
    void bind(int32_t value) { statement_.bind(++bound_, value); }
    void bind(uint32_t value) { statement_.bind(++bound_, value); }
    void bind(int64_t value) { statement_.bind(++bound_, value); }
    void bind(uint64_t value) { statement_.bind(++bound_, static_cast<int64_t>(value)); }
    void bind(double value) { statement_.bind(++bound_, value); }
    void bind(std::string_view value) { statement_.bind(++bound_, std::string(value)); }
    void bind(const std::string& value) { statement_.bind(++bound_, value); }
    void bind(TimePoint value) { bind(int64_t{value.time_since_epoch().count()}); }
    void bind(std::nullopt_t) { statement_.bind(++bound_); }
    void bind(const std::vector<std::byte>& value) {  // a null pointer would bind NULL
        const void* const bytes = value.empty() ? static_cast<const void*>("") : value.data();
        statement_.bind(++bound_, bytes, static_cast<int>(value.size()));
    }
    template <typename Value>
    void bind(const std::optional<Value>& value) {
        value ? bind(*value) : bind(std::nullopt);
    }

    SQLite::Statement& statement_;
    int bound_ = 0;
};

/// A connection and its prepared statements, each made once.
class Connection {
public:
    Connection(const std::string& file, bool writer);
    Query query(const char* sql);
    /// The SQL of all that was prepared so far, for a look at its plans.
    std::vector<std::string> prepared() const;
    SQLite::Database& db() { return db_; }

private:
    SQLite::Database db_;
    std::unordered_map<const char*, std::unique_ptr<SQLite::Statement>> statements_;  // by literal
};

/// The tables of JobStore over one connection.
class SqliteTables {
public:
    explicit SqliteTables(Connection& connection);
    ~SqliteTables();
    Tables tables();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tilefarm
