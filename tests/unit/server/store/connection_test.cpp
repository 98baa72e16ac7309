#include <gtest/gtest.h>

#include "server/store/sqlite_connection.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

constexpr char kTile[] =
    "SELECT 7 AS merged_samples, 1 AS slot, 3 AS tile, 2 AS frame, 5 AS job, 'more' AS more";
constexpr char kTileWithoutSlot[] = "SELECT 5 AS job, 2 AS frame, 3 AS tile, 7 AS merged_samples";
constexpr char kTileOfParameters[] =
    "SELECT :merged_samples AS merged_samples, :slot AS slot, :tile AS tile, :frame AS frame, :job AS job";
constexpr char kOneParameter[] = "SELECT :tile AS tile";
constexpr char kPass[] =
    "SELECT 1 AS job, 0 AS frame, 2 AS tile, 4 AS first_sample, 8 AS samples, 'queued' AS state, 3 AS epoch, "
    ":held_offset AS held_offset, :held_file AS held_file, 0 AS queued_at";

class ConnectionTest : public testing::Test {
protected:
    TemporaryFolder folder_;
    Connection connection_{folder_ / "db", true};
    const TileRow tile_{.job = 5, .frame = 2, .tile = 3, .slot = 1, .mergedSamples = 7};
};

TEST_F(ConnectionTest, ReadsARowByTheNamesOfItsColumnsInAnyOrder) {
    EXPECT_EQ(connection_.query(kTile).first<TileRow>(), tile_);
}

TEST_F(ConnectionTest, BindsARowByTheNamesOfItsColumns) {
    for (int time = 0; time < 2; ++time) {  // the second time with the names looked up
        EXPECT_EQ(connection_.query(kTileOfParameters).setRow(tile_).first<TileRow>(), tile_);
    }
}

TEST_F(ConnectionTest, LooksNamesUpAnewForAnotherTypeOfRow) {
    const LeasedPass pass{.tile = 4, .samples = {}};
    const auto answerTo = [&](const auto& row) {
        auto q = connection_.query(kOneParameter);
        EXPECT_TRUE(q.setRow(row).next());
        return q.value<uint32_t>("tile");
    };
    EXPECT_EQ(answerTo(tile_), 3u);
    EXPECT_EQ(answerTo(pass), 4u);
    EXPECT_EQ(answerTo(tile_), 3u);
}

TEST_F(ConnectionTest, KeepsWhereAHeldPassLiesAndThatNoneIs) {
    PassRow row;
    EXPECT_FALSE(connection_.query(kPass).setRow(row).first<PassRow>()->held);
    row.held = HeldPass{"file", 9};
    const auto found = connection_.query(kPass).setRow(row).first<PassRow>();
    ASSERT_TRUE(found && found->held);
    EXPECT_EQ(found->held->file, "file");
    EXPECT_EQ(found->held->offset, 9u);
    EXPECT_EQ(found->samples.first, 4u);
    EXPECT_EQ(found->samples.count, 8u);
}

TEST_F(ConnectionTest, NamesAColumnThatTheStatementLacks) {
    const Error error = errorOf([&] { connection_.query(kTileWithoutSlot).first<TileRow>(); });
    EXPECT_EQ(error.code, ErrorCode::internal);
    EXPECT_EQ(std::string(error.what()), std::string("no column 'slot' in: ") + kTileWithoutSlot);
}

TEST_F(ConnectionTest, NamesAParameterThatTheStatementLacks) {
    const Error error = errorOf([&] { connection_.query(kOneParameter).set(":slot", 1); });
    EXPECT_EQ(std::string(error.what()), std::string("no parameter ':slot' in: ") + kOneParameter);
}

TEST_F(ConnectionTest, RefusesToRunWithAParameterUnbound) {
    const Error error = errorOf([&] { connection_.query(kOneParameter).next(); });
    EXPECT_EQ(std::string(error.what()), std::string("0 of 1 parameters bound of: ") + kOneParameter);
}

}  // namespace
}  // namespace tilefarm
