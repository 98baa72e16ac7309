#include "server/api/connection_threads.h"

#include <gtest/gtest.h>

#include <future>

namespace tilefarm {
namespace {

size_t stackBytesOfThisThread() {
    pthread_attr_t attributes{};
    size_t bytes = 0;
    pthread_getattr_np(pthread_self(), &attributes);
    pthread_attr_getstacksize(&attributes, &bytes);
    pthread_attr_destroy(&attributes);
    return bytes;
}

TEST(ConnectionThreads, HaveTheSameStackWhateverTheLimitOfTheShell) {
    pthread_attr_t attributes{};
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, 1u << 20);  // what such a limit makes the default
    pthread_setattr_default_np(&attributes);
    pthread_attr_destroy(&attributes);

    ConnectionThreads threads(2);
    std::promise<size_t> bytes;
    threads.run([&] { bytes.set_value(stackBytesOfThisThread()); });
    EXPECT_GE(bytes.get_future().get(), ConnectionThreads::kStackBytes);
}

TEST(ConnectionThreads, FinishWhatTheyWereGivenBeforeTheyStop) {
    int done = 0;
    ConnectionThreads threads(1);
    for (int i = 0; i < 3; ++i) threads.run([&] { ++done; });
    threads.stop();
    EXPECT_EQ(done, 3);
}

}  // namespace
}  // namespace tilefarm
