#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/queue/scheduler_fixture.h"

namespace tilefarm {
namespace {

using testing::HasSubstr;

// Workers with a process and a machine. A killed one is followed by another process on its machine, as a
// supervisor does it; that one knows of the killed one where the machine keeps its cache.
class LossTest : public SchedulerTest {
protected:
    struct Worker {
        std::string machine;
        int process = 0;
        bool keepsCache = true;
        WorkerHello hello(int device = 0) const {
            WorkerHello hello = tilefarm::hello(session(process) + "-" + std::to_string(device));
            hello.host = machine;
            hello.session = session(process);
            if (keepsCache && process > 0) hello.ended = {session(process - 1)};
            return hello;
        }
        std::string session(int number) const { return machine + "/" + std::to_string(number); }
        void restart() { ++process; }
    };

    std::optional<Lease> ask(const Worker& worker, int device = 0) {
        auto answer = scheduler->lease(worker.hello(device), 5);
        if (auto* lease = std::get_if<Lease>(&answer)) return std::move(*lease);
        return std::nullopt;
    }
    // Until the job is set aside; how many processes that took. Others keep what they get.
    int killWhile(const std::string& id, std::vector<Worker*> workers) {
        int killed = 0;
        for (int round = 0; round < 20 && job(id).setAside.empty(); ++round) {
            for (Worker* worker : workers) {
                const auto lease = ask(*worker);
                if (!lease || lease->jobId != id) continue;
                worker->restart();
                ++killed;
            }
            clock.advance(config.leaseTime / 10);
        }
        for (Worker* worker : workers) ask(*worker);  // the last ones are missed now
        return killed;
    }
    std::string submitWithPriority(int priority) {
        JobSpec spec = smallJob();
        spec.priority = priority;
        return submit(spec);
    }

    Worker one{"one"}, two{"two"}, three{"three"};
};

TEST_F(LossTest, SetsAJobAsideThatKilledThreeProcessesOfAMachine) {
    const std::string id = submit();
    EXPECT_EQ(killWhile(id, {&one}), 3);
    const JobRow row = job(id);
    EXPECT_EQ(row.state, JobState::paused);
    EXPECT_THAT(row.setAside, HasSubstr("3 workers were killed, crashed or vanished"));
    EXPECT_THAT(row.setAside, HasSubstr("frame 0, tile 0, samples from 0 (on one)"));
    EXPECT_EQ(scheduler->openLeases(), 0u);
    EXPECT_FALSE(ask(one));
}

TEST_F(LossTest, SetsAJobAsideThatKilledThreeMachines) {
    configure({.mostPixelsPerLease = 256});  // a pass each
    const std::string id = submit();
    EXPECT_EQ(killWhile(id, {&one, &two, &three}), 3 + 2);  // three at once, and the two that tried again
    EXPECT_THAT(job(id).setAside, HasSubstr("(on one, two, three)"));
}

TEST_F(LossTest, SetsAJobAsideWhoseWorkersAreNeverHeardFromAgain) {
    const std::string id = submit();
    for (Worker* worker : {&one, &two, &three}) {
        EXPECT_EQ(job(id).state, worker == &one ? JobState::queued : JobState::running);
        ASSERT_TRUE(ask(*worker));
        clock.advance(config.leaseTime);
        scheduler->expire();
    }
    EXPECT_EQ(job(id).state, JobState::paused);
    EXPECT_FALSE(job(id).setAside.empty());
}

TEST_F(LossTest, GoesOnWithOtherJobsMeanwhile) {
    const std::string poison = submitWithPriority(90), sound = submitWithPriority(10);
    one.keepsCache = false;  // a death shows only when its lease runs out
    ASSERT_EQ(ask(one)->jobId, poison);
    one.restart();
    ASSERT_EQ(ask(two)->jobId, sound);
    scheduler->expire();
    clock.advance(config.leaseTime);
    EXPECT_EQ(killWhile(poison, {&one, &two, &three}), 2);  // one after another
    EXPECT_EQ(job(poison).state, JobState::paused);
    const auto lease = ask(three);
    ASSERT_TRUE(lease);
    EXPECT_EQ(lease->jobId, sound);
    EXPECT_EQ(job(sound).setAside, "");
}

TEST_F(LossTest, CountsNoDeathOfAWorkerThatIsHeardFromAgain) {
    const std::string id = submit();
    for (int i = 0; i < 10; ++i) {
        const auto lost = ask(one);
        ASSERT_TRUE(lost) << i;
        clock.advance(config.leaseTime * 20);  // an outage
        scheduler->expire();
    }
    EXPECT_EQ(job(id).state, JobState::running);
    EXPECT_THAT(job(id).diedOn, testing::SizeIs(1));  // the last one may still be dead
    ask(one);
    EXPECT_THAT(job(id).diedOn, testing::IsEmpty());
    EXPECT_FALSE(job(id).suspectFrame);
}

TEST_F(LossTest, CountsNoDeathOfAWorkerThatRenewsOrDeliversLate) {
    configure({.mostPixelsPerLease = 6 * 256});
    const std::string id = submit();
    const Lease slow = *ask(one), slower = *ask(two);
    clock.advance(config.leaseTime);
    scheduler->expire();
    EXPECT_EQ(job(id).diedOn.size(), 2u);
    EXPECT_EQ(codeOf([&] { scheduler->renew(slow.id, slow.epoch); }), ErrorCode::conflict);
    EXPECT_EQ(job(id).diedOn, std::vector<std::string>{"two"});
    merge(slow);
    merge(slower);
    EXPECT_EQ(job(id).diedOn, std::vector<std::string>{});
}

TEST_F(LossTest, CountsNoDeathForARestartOfTheServer) {
    const std::string id = submit();
    const Lease out = *ask(one);
    for (int i = 0; i < 5; ++i) {
        clock.advance(config.leaseTime * 100);
        restart();
        scheduler->expire();
    }
    EXPECT_NO_THROW(scheduler->renew(out.id, out.epoch));
    EXPECT_TRUE(job(id).diedOn.empty());
}

TEST_F(LossTest, CountsNoDeathOfAWorkerThatHandedItsWorkBack) {
    const std::string id = submit();
    for (int i = 0; i < 5; ++i) {
        const Lease back = *ask(one);
        scheduler->handBack(back.id, back.epoch);
        one.restart();
    }
    EXPECT_TRUE(job(id).diedOn.empty());
}

TEST_F(LossTest, RemembersDeathsOverARestartOfTheServer) {
    const std::string id = submit();
    for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(ask(one)) << i;
        one.restart();
        restart();
    }
    ask(one);
    EXPECT_FALSE(job(id).setAside.empty());
}

TEST_F(LossTest, TakesADeathBackThatItCountedBeforeARestartOfTheServer) {
    const std::string id = submit();
    const Lease slow = *ask(one);
    clock.advance(config.leaseTime);
    scheduler->expire();
    EXPECT_EQ(job(id).diedOn.size(), 1u);
    restart();
    EXPECT_EQ(codeOf([&] { scheduler->renew(slow.id, slow.epoch); }), ErrorCode::conflict);
    EXPECT_TRUE(job(id).diedOn.empty());
    store.read([&](const ConstTables& t) { EXPECT_TRUE(t.leases.lost().empty()); });
}

TEST_F(LossTest, GoesOnByItselfWhenWorkersThatSeemedDeadComeBack) {
    const std::string id = submit();
    for (Worker* worker : {&one, &two, &three}) {
        ask(*worker);
        clock.advance(config.leaseTime);
        scheduler->expire();
    }
    EXPECT_EQ(job(id).state, JobState::paused);
    EXPECT_TRUE(ask(two));
    EXPECT_EQ(job(id).state, JobState::running);
    EXPECT_EQ(job(id).setAside, "");
}

// A process of two devices: which of the two jobs ended it?
TEST_F(LossTest, BlamesNoJobThatSharedTheProcessWithThePoison) {
    const std::string sound = submitWithPriority(90);
    JobSpec spec = smallJob();
    spec.priority = 10;
    const std::string poison = submit(spec);
    ASSERT_EQ(ask(one, 0)->jobId, sound);
    ASSERT_EQ(ask(one, 1)->jobId, poison);
    one.restart();

    // Both are suspect now, neither is blamed; they are tried one by one, with nothing beside them.
    const Lease trial = *ask(one, 0);
    EXPECT_EQ(trial.jobId, sound);
    EXPECT_TRUE(job(sound).diedOn.empty());
    EXPECT_TRUE(job(poison).diedOn.empty());
    EXPECT_FALSE(ask(one, 1));
    merge(trial);
    while (job(sound).passesMerged < job(sound).passes) merge(ask(one).value());
    EXPECT_EQ(killWhile(poison, {&one}), 3);
    EXPECT_EQ(job(sound).setAside, "");
    EXPECT_FALSE(job(poison).setAside.empty());
}

TEST_F(LossTest, WaitsForAProcessToFinishWhatItHasBeforeATrial) {
    const std::string poison = submitWithPriority(90);
    ask(one);
    one.restart();
    scheduler->pause(poison);
    const std::string sound = submitWithPriority(10);
    const Lease beside = *ask(one, 0);
    EXPECT_EQ(beside.jobId, sound);
    scheduler->resume(poison);
    EXPECT_FALSE(ask(one, 1));
    merge(beside);
    EXPECT_EQ(ask(one, 1)->jobId, poison);
    EXPECT_FALSE(ask(one, 0));
}

TEST_F(LossTest, LeavesAJobToMachinesThatSurviveIt) {
    const std::string id = submit();
    ask(two);  // is online
    clock.advance(config.leaseTime);
    ask(two);
    clock.advance(config.leaseTime / 2);
    const std::string small = submitWithPriority(90);
    ASSERT_EQ(ask(one)->jobId, small);
    one.restart();
    EXPECT_NE(ask(one).value_or(Lease{}).jobId, small);  // not again where it killed
    EXPECT_EQ(job(small).diedOn, std::vector<std::string>{"one"});
}

TEST_F(LossTest, SetsAJobAsideForOnePoisonFrameAmongSoundOnes) {
    JobSpec spec = smallJob();
    spec.frames = {.first = 0, .count = 3};
    const std::string id = submit(spec);
    merge(*ask(one));  // frame 0 is sound
    EXPECT_EQ(killWhile(id, {&one}), 3);
    EXPECT_THAT(job(id).setAside, HasSubstr("frame 1, "));
    EXPECT_EQ(frame(id, 0).passesMerged, 24u);
}

TEST_F(LossTest, KeepsOnHandingOutAJobOfWhichOthersMergeMeanwhile) {
    configure({.mostPixelsPerLease = 256});
    const std::string id = submit();
    const Lease lost = *ask(one), merged = *ask(two);
    merge(merged);
    clock.advance(config.leaseTime);
    scheduler->expire();
    EXPECT_FALSE(job(id).suspectFrame);
    EXPECT_TRUE(ask(two));
    EXPECT_TRUE(ask(three));  // at once: the job is evidently one that can be rendered
}

TEST_F(LossTest, TriesAgainFromTheBeginningWhenAPersonResumesIt) {
    const std::string id = submit();
    killWhile(id, {&one});
    EXPECT_EQ(scheduler->resume(id).setAside, "");
    EXPECT_EQ(job(id).state, JobState::running);
    EXPECT_EQ(killWhile(id, {&one}), 3);
    scheduler->resume(id);
    while (job(id).passesMerged < 24) merge(ask(one).value());
    EXPECT_FALSE(job(id).suspectFrame);
}

TEST_F(LossTest, SetsNoJobAsideThatAPersonHasPaused) {
    const std::string id = submit();
    for (int i = 0; i < 2; ++i) {
        ASSERT_TRUE(ask(one));
        one.restart();
    }
    ASSERT_TRUE(ask(one));
    scheduler->pause(id);
    one.restart();
    ask(one);
    EXPECT_EQ(job(id).setAside, "");
    scheduler->resume(id);
    ASSERT_TRUE(ask(one));
    one.restart();
    ask(one);
    EXPECT_THAT(job(id).setAside, HasSubstr("4 workers"));
}

TEST_F(LossTest, CountsUpToTheConfiguredLimitOrForEver) {
    configure({.deathsThatSetAside = 2});
    EXPECT_EQ(killWhile(submit(), {&one}), 2);
    configure({.deathsThatSetAside = 0});
    const std::string id = submit();
    EXPECT_EQ(killWhile(id, {&one}), 20);
    EXPECT_EQ(job(id).state, JobState::running);
}

TEST_F(LossTest, EndsAJobThatIsSetAsideLikeAnyOther) {
    const std::string id = submit();
    killWhile(id, {&one});
    EXPECT_EQ(scheduler->cancel(id).state, JobState::canceled);
    EXPECT_EQ(job(id).setAside, "");
    store.read([&](const ConstTables& t) { EXPECT_EQ(t.leases.deadly(job(id).key, 1), std::nullopt); });
}

}  // namespace
}  // namespace tilefarm
