#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/store/sqlite_columns.h"

namespace tilefarm {

/// A statement that was prepared, and where its columns and parameters are. Names are looked up once for a
/// type of row. Throws Error(internal) that names the statement and what it lacks.
class PreparedStatement {
public:
    PreparedStatement(SQLite::Database& db, const char* sql);

    SQLite::Statement& statement() { return statement_; }
    const SQLite::Statement& statement() const { return statement_; }
    int column(const char* name) const;
    /// `name` begins with a colon.
    int parameter(const char* name) const;
    /// Every parameter has to be bound before the statement runs.
    void expectBound(int parameters) const;

    /// Of each of columnsOf<Row>, its index; all have to be there.
    template <typename Row>
    const std::vector<int>& columns() {
        return lookedUp(columns_, columnsOf<Row>(), [this](const char* name) { return column(name); });
    }
    /// Of each of columnsOf<Row>, its parameter; 0 for those that the statement does not take.
    template <typename Row>
    const std::vector<int>& parameters() {
        return lookedUp(parameters_, columnsOf<Row>(), [this](const char* name) {
            return statement_.getIndex((std::string(":") + name).c_str());
        });
    }

private:
    struct Indices {
        const void* row = nullptr;  // the columns for which `of` holds
        std::vector<int> of;
    };
    template <typename Row, typename Look>
    static const std::vector<int>& lookedUp(Indices& known, std::span<const Column<Row>> columns,
                                            const Look& look) {
        if (known.row != columns.data()) {
            known.of.clear();
            for (const Column<Row>& column : columns) known.of.push_back(look(column.name));
            known.row = columns.data();
        }
        return known.of;
    }

    SQLite::Statement statement_;
    Indices columns_, parameters_;
};

/// A prepared statement for the length of a scope. Values go in and come out by name.
class Query {
public:
    explicit Query(PreparedStatement& prepared) : prepared_(prepared) {}
    ~Query() { prepared_.statement().tryReset(); }
    Query(const Query&) = delete;
    Query& operator=(const Query&) = delete;

    /// Binds one parameter, whose name begins with a colon.
    template <typename Value>
    Query& set(const char* parameter, const Value& value) {
        bindValue(prepared_.statement(), prepared_.parameter(parameter), value);
        ++bound_;
        return *this;
    }
    /// Binds the parameters that are named as columns of the row.
    template <typename Row>
    Query& setRow(const Row& row) {
        const std::vector<int>& parameters = prepared_.parameters<Row>();
        for (size_t i = 0; i < parameters.size(); ++i) {
            if (parameters[i] == 0) continue;
            columnsOf<Row>()[i].bind(row, prepared_.statement(), parameters[i]);
            ++bound_;
        }
        return *this;
    }

    bool next() {
        prepared_.expectBound(bound_);
        return prepared_.statement().executeStep();
    }
    /// For a statement without rows; how many it changed.
    uint64_t run() {
        prepared_.expectBound(bound_);
        return static_cast<uint64_t>(prepared_.statement().exec());
    }

    /// Of the present row.
    template <typename Value>
    Value value(const char* column) const {
        Value value{};
        readValue(prepared_.statement().getColumn(prepared_.column(column)), value);
        return value;
    }
    template <typename Row>
    Row row() {
        const std::vector<int>& indices = prepared_.columns<Row>();
        Row row{};
        for (size_t i = 0; i < indices.size(); ++i) {
            columnsOf<Row>()[i].read(prepared_.statement().getColumn(indices[i]), row);
        }
        return row;
    }
    template <typename Row>
    std::optional<Row> first() {
        return next() ? std::optional(row<Row>()) : std::nullopt;
    }
    template <typename Row>
    std::vector<Row> all() {
        std::vector<Row> found;
        while (next()) found.push_back(row<Row>());
        return found;
    }

private:
    PreparedStatement& prepared_;
    int bound_ = 0;
};

/// A connection and its prepared statements, each made once.
class Connection {
public:
    Connection(const std::string& file, bool writer);
    /// A statement of server/store/sql. It is known by its address.
    Query query(const char* sql);
    /// The SQL of all that was prepared so far, for a look at its plans.
    std::vector<std::string> prepared() const;
    SQLite::Database& db() { return db_; }

private:
    SQLite::Database db_;
    std::unordered_map<const char*, std::unique_ptr<PreparedStatement>> statements_;
};

}  // namespace tilefarm
