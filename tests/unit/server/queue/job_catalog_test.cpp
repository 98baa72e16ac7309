#include "server/queue/job_catalog.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "shared/job/wire.h"
#include "tests/support/memory_job_store.h"
#include "tests/unit/server/support/test_farm.h"

namespace tilefarm {
namespace {

// A job more than fits turns out the one that was not used for longest, and no other.
TEST(JobCatalog, KeepsTheJobsUsedLast) {
    MemoryJobStore store;
    const std::string spec = toJson(smallJob()).dump();
    std::vector<JobRow> rows(4);
    store.write([&](Tables& t) {
        for (size_t i = 0; i < rows.size(); ++i) {
            rows[i].id = "j" + std::to_string(i);
            rows[i].passes = 1;
            rows[i].key = t.jobs.insert(rows[i], spec);
        }
    });
    JobCatalog catalog(3 * spec.size());
    store.read([&](const ConstTables& t) {
        std::vector<std::shared_ptr<const JobInfo>> first;
        for (size_t i = 0; i < 3; ++i) first.push_back(catalog.get(t, rows[i]));
        EXPECT_EQ(catalog.get(t, rows[0]), first[0]);
        EXPECT_EQ(catalog.get(t, rows[3])->id, "j3");
        EXPECT_EQ(catalog.get(t, rows[0]), first[0]);
        EXPECT_EQ(catalog.get(t, rows[2]), first[2]);
        EXPECT_NE(catalog.get(t, rows[1]), first[1]) << "parsed again";
    });
}

TEST(JobCatalog, GivesAJobThatIsLargerThanAllItKeeps) {
    MemoryJobStore store;
    JobRow row;
    row.id = "j";
    row.passes = 1;
    store.write([&](Tables& t) { row.key = t.jobs.insert(row, toJson(smallJob()).dump()); });
    JobCatalog catalog(10);
    store.read([&](const ConstTables& t) {
        EXPECT_EQ(catalog.get(t, row)->spec, smallJob());
        EXPECT_NE(catalog.get(t, row), catalog.get(t, row));
    });
}

}  // namespace
}  // namespace tilefarm
