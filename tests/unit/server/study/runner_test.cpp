#include "server/study/runner.h"

#include <gtest/gtest.h>

#include "server/study/result.h"
#include "shared/job/wire.h"
#include "tests/support/expect_error.h"
#include "tests/unit/server/support/test_farm.h"

namespace tilefarm {
namespace {

using nlohmann::json;

class StudyRunnerTest : public testing::Test {
protected:
    static StudyRequest request(uint32_t seeds = 2) {
        json study{{"job", toJson(smallJob(4))},
                   {"samples", {2, 4}},
                   {"seeds", seeds},
                   {"reference", {{"samples", 8}}}};
        study["knobs"] = json::parse(R"([{"path": "settings.clampIndirect", "values": [1]}])");
        return studyFromJson(study);
    }
    StudyRunner runner() { return {*farm.store, *farm.scheduler, *farm.images, farm.clock}; }
    StudyRow study(const std::string& id) {
        StudyRow row;
        farm.store->read([&](const ConstTables& t) { row = t.studies.find(id).value(); });
        return row;
    }
    size_t jobs() {
        size_t count = 0;
        farm.store->read(
            [&](const ConstTables& t) { count = t.jobs.list({.state = {}, .limit = 1000}).size(); });
        return count;
    }
    std::vector<std::string> results(const std::string& id) {
        std::vector<std::string> found;
        farm.store->read([&](const ConstTables& t) {
            for (const StudyCellRow& cell : t.studies.cells(study(id).key)) found.push_back(cell.resultJson);
        });
        return found;
    }
    // Everything is made anew between any two steps, as if the server had been killed there.
    StudyRow runToTheEnd(const std::string& id) {
        for (int i = 0; i < 100 && !study(id).finished; ++i) {
            runner().step();
            farm.reopen();
            farm.finish();
        }
        return study(id);
    }

    TestFarm farm;
};

TEST_F(StudyRunnerTest, MakesItsJobsOnceAndMeasuresEveryCell) {
    const std::string id = runner().create(request()).id;
    const StudyRow row = runToTheEnd(id);
    EXPECT_EQ(row.state, StudyState::completed) << row.fault;
    EXPECT_EQ(jobs(), 1u + 4 * 2);  // the reference; two variants at two counts with two seeds
    EXPECT_EQ(results(id).size(), 4u);
}

TEST_F(StudyRunnerTest, SharesAReferenceAndRepeatsToTheBit) {
    const std::string first = runner().create(request()).id, second = runner().create(request()).id;
    EXPECT_EQ(runToTheEnd(first).state, StudyState::completed);
    EXPECT_EQ(runToTheEnd(second).state, StudyState::completed);
    EXPECT_EQ(jobs(), 1u + 2 * 4 * 2);
    ASSERT_EQ(results(first).size(), results(second).size());
    for (size_t i = 0; i < results(first).size(); ++i) {
        json a = json::parse(results(first)[i]), b = json::parse(results(second)[i]);
        EXPECT_EQ(a["metrics"], b["metrics"]);
        EXPECT_EQ(a["mse"], b["mse"]);
        EXPECT_EQ(a["variance"], b["variance"]);
    }
}

TEST_F(StudyRunnerTest, CancelsItsJobsWithItself) {
    const std::string id = runner().create(request()).id;
    runner().step();
    EXPECT_GT(jobs(), 1u);
    EXPECT_EQ(runner().cancel(id).state, StudyState::canceled);
    EXPECT_FALSE(study(id).finished);
    runner().step();
    EXPECT_TRUE(study(id).finished);
    farm.store->read([](const ConstTables& t) {
        for (const JobRow& job : t.jobs.list({.state = {}, .limit = 1000}))
            EXPECT_EQ(job.state, JobState::canceled);
    });
    EXPECT_EQ(runner().cancel(id).state, StudyState::canceled);  // asked twice
    EXPECT_EQ(codeOf([&] { runner().cancel("s1"); }), ErrorCode::notFound);
    // The reference that was lost with it is made again for another.
    EXPECT_EQ(runToTheEnd(runner().create(request()).id).state, StudyState::completed);
}

TEST_F(StudyRunnerTest, FailsWithAJobThatIsLost) {
    const std::string id = runner().create(request()).id;
    runner().step();
    std::string lost;
    farm.store->read(
        [&](const ConstTables& t) { lost = t.jobs.findByIdempotencyKey(studyJobKey(id, 0, 1))->id; });
    farm.scheduler->cancel(lost);
    const StudyRow row = runToTheEnd(id);
    EXPECT_EQ(row.state, StudyState::failed);
    EXPECT_EQ(row.fault, "job '" + lost + "' is canceled");
    EXPECT_EQ(codeOf([&] { runner().cancel(id); }), ErrorCode::conflict);
}

TEST_F(StudyRunnerTest, KeepsFewJobsOpenAtATime) {
    const std::string id = runner().create(request(64)).id;  // 256 and a reference
    runner().step();
    runner().step();
    EXPECT_EQ(jobs(), 65u);
    farm.store->read([&](const ConstTables& t) {
        const auto progress = StudyRunner::progress(t, study(id), StudyPlan(request(64)));
        EXPECT_EQ(progress.jobs, 257u);
        EXPECT_EQ(progress.jobsDone, 0u);
        EXPECT_FALSE(progress.reference.empty());
    });
}

}  // namespace
}  // namespace tilefarm
