#include "server/store/sqlite_connection.h"

#include <fmt/format.h>

#include <string_view>

#include "shared/error/error.h"

namespace tilefarm {
namespace {

constexpr const char* kPragmas = R"sql(
PRAGMA journal_mode = WAL;
PRAGMA synchronous = FULL;
PRAGMA mmap_size = 0;
PRAGMA foreign_keys = ON;
PRAGMA busy_timeout = 10000;
)sql";

}  // namespace

PreparedStatement::PreparedStatement(SQLite::Database& db, const char* sql) : statement_(db, sql) {}

int PreparedStatement::column(const char* name) const {
    for (int i = 0; i < statement_.getColumnCount(); ++i) {
        if (std::string_view(name) == statement_.getColumnName(i)) return i;
    }
    throw Error(ErrorCode::internal, fmt::format("no column '{}' in: {}", name, statement_.getQuery()));
}

int PreparedStatement::parameter(const char* name) const {
    if (const int found = statement_.getIndex(name)) return found;
    throw Error(ErrorCode::internal, fmt::format("no parameter '{}' in: {}", name, statement_.getQuery()));
}

void PreparedStatement::expectBound(int parameters) const {
    if (const int all = statement_.getBindParameterCount(); parameters != all) {
        throw Error(ErrorCode::internal,
                    fmt::format("{} of {} parameters bound of: {}", parameters, all, statement_.getQuery()));
    }
}

Connection::Connection(const std::string& file, bool writer)
    : db_(file, SQLite::OPEN_READWRITE | (writer ? SQLite::OPEN_CREATE : 0)) {
    db_.exec(kPragmas);
    if (!writer) db_.exec("PRAGMA query_only = ON");
}

Query Connection::query(const char* sql) {
    auto& statement = statements_[sql];
    if (!statement) statement = std::make_unique<PreparedStatement>(db_, sql);
    statement->statement().clearBindings();
    return Query(*statement);
}

std::vector<std::string> Connection::prepared() const {
    std::vector<std::string> sql;
    for (const auto& [literal, statement] : statements_) sql.push_back(statement->statement().getQuery());
    return sql;
}

}  // namespace tilefarm
