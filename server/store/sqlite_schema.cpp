#include "server/store/sqlite_schema.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "shared/error/error.h"
#include "sql/migrations.h"

namespace tilefarm {

int newestSchemaVersion() {
    return static_cast<int>(sql::migrations.size());
}

void migrate(SQLite::Database& db, int version) {
    const int found = db.execAndGet("PRAGMA user_version").getInt();
    if (found > newestSchemaVersion()) {
        throw Error(
            ErrorCode::versionRefused,
            fmt::format("the database '{}' has schema version {}, this program knows {}: a newer Tilefarm "
                        "wrote it",
                        db.getFilename(), found, newestSchemaVersion()));
    }
    for (int next = found; next < version; ++next) {
        SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
        db.exec(sql::migrations.at(next));
        db.exec(fmt::format("PRAGMA user_version = {}", next + 1));
        transaction.commit();
    }
}

}  // namespace tilefarm
