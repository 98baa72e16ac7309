#pragma once

namespace SQLite {
class Database;
}

namespace tilefarm {

/// The schema version this program writes.
int newestSchemaVersion();
/// Brings a database to the newest schema, a migration per transaction. Throws Error(versionRefused)
/// if a newer Tilefarm wrote it. An older version to stop at makes the database of an older Tilefarm.
void migrate(SQLite::Database& db, int version = newestSchemaVersion());

}  // namespace tilefarm
