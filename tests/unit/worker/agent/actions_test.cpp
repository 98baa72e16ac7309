#include "worker/agent/actions.h"

#include <gtest/gtest.h>

namespace tilefarm {
namespace {

using enum ErrorCode;

constexpr Endpoint kEndpoints[] = {Endpoint::lease,    Endpoint::blob,    Endpoint::renew, Endpoint::result,
                                   Endpoint::handBack, Endpoint::failure, Endpoint::report};

TEST(Actions, CredentialsAndVersionsStopAWorkerWhereverTheyAreRefused) {
    for (const Endpoint endpoint : kEndpoints)
        for (const ErrorCode code : {unauthorized, forbidden, versionRefused})
            EXPECT_EQ(actionFor(endpoint, code), Action::stop) << toString(endpoint);
}

TEST(Actions, AServerThatIsAwayOrBusyIsTriedAgain) {
    for (const Endpoint endpoint : kEndpoints)
        for (const ErrorCode code : {unavailable, tooMany})
            EXPECT_EQ(actionFor(endpoint, code), Action::retry) << toString(endpoint);
}

TEST(Actions, ALowDiskHoldsWorkers) {
    for (const Endpoint endpoint : kEndpoints)
        EXPECT_EQ(actionFor(endpoint, outOfSpace), Action::hold) << toString(endpoint);
}

TEST(Actions, AJobThatIsGoneIsDroppedByAllWhoHoldALease) {
    for (const Endpoint endpoint : kEndpoints) {
        if (endpoint == Endpoint::lease) continue;
        EXPECT_EQ(actionFor(endpoint, gone), Action::dropJob) << toString(endpoint);
    }
}

TEST(Actions, ALostLeaseIsDroppedAndNothingElse) {
    for (const Endpoint endpoint : {Endpoint::renew, Endpoint::result, Endpoint::handBack, Endpoint::failure})
        for (const ErrorCode code : {conflict, notFound})
            EXPECT_EQ(actionFor(endpoint, code), Action::dropLease) << toString(endpoint);
}

TEST(Actions, RefusedBytesAreNotSentAgain) {
    for (const ErrorCode code : {invalidArgument, tooLarge, unprocessable}) {
        EXPECT_EQ(actionFor(Endpoint::result, code), Action::refused);
        EXPECT_EQ(actionFor(Endpoint::blob, code), Action::refused);
    }
    EXPECT_EQ(actionFor(Endpoint::blob, notFound), Action::refused);
}

TEST(Actions, AWrongAddressStopsAWorkerThatAsksForWork) {
    EXPECT_EQ(actionFor(Endpoint::lease, notFound), Action::stop);
    EXPECT_EQ(actionFor(Endpoint::lease, invalidArgument), Action::stop);
}

TEST(Actions, AFaultOfTheServerIsNotRetriedForEverOverOneRequest) {
    EXPECT_EQ(actionFor(Endpoint::lease, internal), Action::retry);
    EXPECT_EQ(actionFor(Endpoint::renew, internal), Action::retry);
    for (const Endpoint endpoint : {Endpoint::blob, Endpoint::result, Endpoint::failure})
        EXPECT_EQ(actionFor(endpoint, internal), Action::retryFew) << toString(endpoint);
}

TEST(Actions, CourtesiesNeverStandInTheWay) {
    for (const Endpoint endpoint : {Endpoint::handBack, Endpoint::report})
        for (const ErrorCode code : {internal, conflict, notFound, invalidArgument, unprocessable})
            EXPECT_EQ(actionFor(endpoint, code), Action::dropLease) << toString(endpoint);
}

}  // namespace
}  // namespace tilefarm
