#include "server/config.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

ServerConfig parse(std::vector<std::string> words) {
    words.insert(words.begin(), {"tilefarm-server", "--data", "/tmp/x"});
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    return parseCommandLine(static_cast<int>(argv.size()), argv.data());
}

TEST(ServerConfig, ReadsHostAndPort) {
    EXPECT_EQ(parse({}).http.host, "127.0.0.1");
    EXPECT_EQ(parse({"--listen", "127.0.0.1:0"}).http.port, 0);
    EXPECT_EQ(parse({"--listen", "[::1]:8080"}).http.host, "::1");
    EXPECT_EQ(parse({"--lease-seconds", "1.5"}).queue.leaseTime, Milliseconds(1500));
    EXPECT_EQ(parse({}).queue.deathsThatSetAside, 3u);
    EXPECT_EQ(parse({"--set-aside-after", "0"}).queue.deathsThatSetAside, 0u);
    for (const char* bad : {"127.0.0.1", ":80", "host:", "host:x", "host:70000", "host:-1"}) {
        EXPECT_EQ(codeOf([&] { parse({"--listen", bad}); }), ErrorCode::invalidArgument) << bad;
    }
}

TEST(ServerConfig, LetsOtherMachinesInOnlyWithATokenOrOnDemand) {
    EXPECT_EQ(codeOf([] { parse({"--listen", "0.0.0.0:80"}); }), ErrorCode::invalidArgument);
    EXPECT_EQ(parse({"--listen", "0.0.0.0:80", "--insecure"}).http.host, "0.0.0.0");
    const TemporaryFolder folder;
    std::ofstream(folder / "token") << "secret\r\n";
    EXPECT_EQ(parse({"--listen", "0.0.0.0:80", "--token-file", folder / "token"}).api.token, "secret");
    std::ofstream(folder / "empty") << "\n";
    EXPECT_EQ(codeOf([&] { parse({"--token-file", folder / "empty"}); }), ErrorCode::invalidArgument);
    EXPECT_EQ(codeOf([&] { parse({"--token-file", folder / "absent"}); }), ErrorCode::invalidArgument);
}

}  // namespace
}  // namespace tilefarm
