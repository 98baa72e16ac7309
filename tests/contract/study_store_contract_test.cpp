#include <gtest/gtest.h>

#include "server/store/sqlite_job_store.h"
#include "tests/contract/backend_name.h"
#include "tests/support/expect_error.h"
#include "tests/support/memory_job_store.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

using MakeStudyStore = std::function<std::unique_ptr<JobStore>(const TemporaryFolder&)>;

class StudyStoreContract : public testing::TestWithParam<MakeStudyStore> {
protected:
    int64_t add(const std::string& id) {
        int64_t key = 0;
        store->write([&](Tables& t) {
            key = t.studies.insert({.id = id,
                                    .requestJson = "{\"of\":\"" + id + "\"}",
                                    .created = TimePoint{Milliseconds{5}},
                                    .finished = {},
                                    .fault = {}});
        });
        return key;
    }
    StudyRow find(const std::string& id) {
        StudyRow row;
        store->read([&](const ConstTables& t) { row = t.studies.find(id).value(); });
        return row;
    }
    void update(const StudyRow& row) {
        store->write([&](Tables& t) { t.studies.update(row); });
    }

    TemporaryFolder folder;
    std::unique_ptr<JobStore> store = GetParam()(folder);
};

TEST_P(StudyStoreContract, KeepsAStudy) {
    const int64_t key = add("a");
    StudyRow row = find("a");
    EXPECT_EQ(row.key, key);
    EXPECT_EQ(row.state, StudyState::running);
    EXPECT_EQ(row.requestJson, R"({"of":"a"})");
    EXPECT_EQ(row.created, TimePoint{Milliseconds{5}});
    EXPECT_FALSE(row.finished);
    row.state = StudyState::failed;
    row.finished = TimePoint{Milliseconds{9}};
    row.fault = "why";
    update(row);
    EXPECT_EQ(find("a").state, StudyState::failed);
    EXPECT_EQ(find("a").finished, TimePoint{Milliseconds{9}});
    EXPECT_EQ(find("a").fault, "why");
    store->read([](const ConstTables& t) { EXPECT_FALSE(t.studies.find("b")); });
    EXPECT_EQ(codeOf([&] { add("a"); }), ErrorCode::conflict);
}

TEST_P(StudyStoreContract, MovesAStudyOnceAndOutOfRunningAlone) {
    for (const StudyState ended : {StudyState::completed, StudyState::failed, StudyState::canceled}) {
        const std::string id(toString(ended));
        add(id);
        StudyRow row = find(id);
        row.state = ended;
        update(row);
        row.state = StudyState::running;
        EXPECT_EQ(codeOf([&] { update(row); }), ErrorCode::conflict);
        row.state = ended;
        row.finished = TimePoint{Milliseconds{1}};
        update(row);
    }
}

TEST_P(StudyStoreContract, ListsTheNewestFirstAndOpenOnesInOrder) {
    const int64_t a = add("a"), b = add("b"), c = add("c");
    StudyRow ended = find("b");
    ended.state = StudyState::canceled;
    update(ended);
    store->read([&](const ConstTables& t) {
        ASSERT_EQ(t.studies.list(INT64_MAX, 2).size(), 2u);
        EXPECT_EQ(t.studies.list(INT64_MAX, 2)[0].key, c);
        EXPECT_EQ(t.studies.list(b, 2)[0].key, a);
        EXPECT_EQ(t.studies.open().size(), 3u);  // its jobs are still to be canceled
    });
    ended.finished = TimePoint{Milliseconds{1}};
    update(ended);
    store->read([&](const ConstTables& t) {
        ASSERT_EQ(t.studies.open().size(), 2u);
        EXPECT_EQ(t.studies.open()[0].id, "a");
    });
}

TEST_P(StudyStoreContract, KeepsWhatWasMeasuredAndThePicturesApart) {
    const int64_t key = add("a"), other = add("b");
    store->write([&](Tables& t) {
        t.studies.putCell({key, 1, "{}", "[1]"});
        t.studies.putCell({key, 0, "{}", "[0]"});
        t.studies.putCell({other, 0, "{}", "[2]"});
        t.studies.putCell({key, 0, "{\"again\":1}", "[3]"});
    });
    store->read([&](const ConstTables& t) {
        const auto cells = t.studies.cells(key);
        ASSERT_EQ(cells.size(), 2u);
        EXPECT_EQ(cells[0].resultJson, "{\"again\":1}");
        EXPECT_EQ(cells[0].picturesJson, "");
        EXPECT_EQ(cells[1].cell, 1u);
        EXPECT_EQ(t.studies.cell(key, 0)->picturesJson, "[3]");
        EXPECT_FALSE(t.studies.cell(key, 2));
    });
    EXPECT_EQ(codeOf([&] { store->write([&](Tables& t) {
                               t.studies.putCell({99, 0, "{}", ""});
                           }); }),
              ErrorCode::conflict);
}

INSTANTIATE_TEST_SUITE_P(Memory, StudyStoreContract, testing::Values([](const TemporaryFolder&) {
                             return std::make_unique<MemoryJobStore>();
                         }),
                         backendName("Memory"));
INSTANTIATE_TEST_SUITE_P(Sqlite, StudyStoreContract, testing::Values([](const TemporaryFolder& folder) {
                             return std::make_unique<SqliteJobStore>(folder / "tilefarm.sqlite");
                         }),
                         backendName("Sqlite"));

}  // namespace
}  // namespace tilefarm
