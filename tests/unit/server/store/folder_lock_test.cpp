#include "server/store/folder_lock.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"

namespace tilefarm {
namespace {

TEST(FolderLock, LetsOneInAtATime) {
    const TemporaryFolder folder;
    {
        const FolderLock first(folder / "data");
        EXPECT_EQ(codeOf([&] { FolderLock second(folder / "data"); }), ErrorCode::unavailable);
    }
    EXPECT_NO_THROW(FolderLock(folder / "data"));
}

TEST(FolderLock, NamesAFolderThatCannotBeMade) {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "in the way";
    const Error error = errorOf([&] { FolderLock lock(folder / "file/data"); });
    EXPECT_NE(std::string(error.what()).find("file"), std::string::npos);
}

}  // namespace
}  // namespace tilefarm
