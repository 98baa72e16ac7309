#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include <fstream>

#include "server/store/sqlite_job_store.h"
#include "server/store/sqlite_schema.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

TEST(SqliteSchema, KeepsWhatIsThereOnASecondOpen) {
    const TemporaryFolder folder;
    JobRow row;
    row.id = "a";
    row.passes = row.frames = 1;
    {
        SqliteJobStore(folder / "db").write([&](Tables& t) { t.jobs.insert(row); });
    }
    SqliteJobStore(folder / "db").read([](const ConstTables& t) { EXPECT_TRUE(t.jobs.find("a")); });
}

TEST(SqliteSchema, RefusesADatabaseOfANewerProgram) {
    const TemporaryFolder folder;
    SQLite::Database(folder / "db", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE)
        .exec("PRAGMA user_version = " + std::to_string(newestSchemaVersion() + 1));
    const Error error = errorOf([&] { SqliteJobStore(folder / "db"); });
    EXPECT_EQ(error.code, ErrorCode::versionRefused);
    EXPECT_NE(std::string(error.what()).find("newer"), std::string::npos);
}

TEST(SqliteSchema, NamesAFileThatIsNoDatabase) {
    const TemporaryFolder folder;
    std::ofstream(folder / "db") << std::string(5000, 'x');
    const Error error = errorOf([&] { SqliteJobStore(folder / "db"); });
    EXPECT_NE(std::string(error.what()).find(folder / "db"), std::string::npos);
}

TEST(SqliteSchema, KeepsAWriteAheadLog) {
    const TemporaryFolder folder;
    const SqliteJobStore store(folder / "db");
    SQLite::Database db(folder / "db", SQLite::OPEN_READONLY);
    EXPECT_EQ(db.execAndGet("PRAGMA journal_mode").getString(), "wal");
}

}  // namespace
}  // namespace tilefarm
