#pragma once

namespace SQLite {
class Database;
}

namespace tilefarm {

/// Brings a database to the newest schema, a migration per transaction. Throws Error(versionRefused)
/// if a newer Tilefarm wrote it.
void migrate(SQLite::Database& db);
/// The schema version this program writes.
int newestSchemaVersion();

}  // namespace tilefarm
