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
        SqliteJobStore(folder / "db").write([&](Tables& t) { t.jobs.insert(row, "{}"); });
    }
    SqliteJobStore(folder / "db").read([](const ConstTables& t) { EXPECT_TRUE(t.jobs.find("a")); });
}

// The database of each version there was, with a job in it, opened by this program.
constexpr int kSpecsApart = 9;  // the first version with the text of a job in a table of its own

// A job with one frame, as a program of that schema wrote it.
void insertJob(SQLite::Database& old, int version) {
    const std::string spec = R"('{"scene":{"entry":"a","files":{"a":"1","b":"2"}}}')";
    const bool apart = version >= kSpecsApart;
    old.exec(
        "INSERT INTO jobs (id, state, priority, body_digest, created, passes, passes_merged, pixel_samples, "
        "pixel_samples_merged, frames, frames_started, frames_done, samples_merged, device_seconds, "
        "dropped_samples, faults, " +
        std::string(apart ? "outline" : "spec") +
        ") VALUES ('a', 'running', 50, '', 0, 9, 3, 90, 30, 1, 1, 0, 0, 1.5, 0, 'one' || char(10), " +
        (apart ? R"('{"scene":{"entry":"a","files":{"a":"1"}}}')" : spec) + ")");
    if (apart) old.exec("INSERT INTO specs VALUES (1, " + spec + ")");
    old.exec(
        "INSERT INTO frames (job, frame, state, levels, levels_created, tiles, passes_merged, passes_queued, "
        "passes_leased, samples_merged, device_seconds, dropped_samples, revision, exr_sha256, exr_bytes) "
        "VALUES (1, 0, 'active', 1, 1, 9, 3, 4, 2, 0, 0, 0, 0, '', 0)");
}

TEST(SqliteSchema, TakesOverADatabaseOfEveryOlderProgram) {
    for (int version = 1; version < newestSchemaVersion(); ++version) {
        const TemporaryFolder folder;
        {
            SQLite::Database old(folder / "db", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
            migrate(old, version);
            EXPECT_EQ(old.execAndGet("PRAGMA user_version").getInt(), version);
            insertJob(old, version);
        }
        SqliteJobStore store(folder / "db");
        store.write([&](Tables& t) {
            JobRow job = t.jobs.find("a").value();
            EXPECT_EQ(job.passesMerged, 3u) << version;
            EXPECT_EQ(job.faults, std::vector<std::string>{"one"}) << version;
            EXPECT_EQ(t.jobs.spec(job.key), R"({"scene":{"entry":"a","files":{"a":"1","b":"2"}}})")
                << version;
            EXPECT_EQ(job.outlineJson, R"({"scene":{"entry":"a","files":{"a":"1"}}})") << version;
            EXPECT_EQ(t.jobs.totals().at(JobState::running), (JobTotals{1, 9, 3, 4, 2})) << version;
            job.passesMerged = 4;
            t.jobs.update(job);
        });
        SQLite::Database now(folder / "db", SQLite::OPEN_READONLY);
        EXPECT_EQ(now.execAndGet("PRAGMA user_version").getInt(), newestSchemaVersion());
    }
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
