#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "shared/digest/digest.h"
#include "tests/support/expect_error.h"
#include "tests/support/temporary_folder.h"
#include "worker/blob_cache/blob_cache.h"

namespace tilefarm {

/// A cache before a store of blobs that counts what is fetched and can be made to send rubbish.
class BlobFixture : public testing::Test {
protected:
    std::string add(const std::string& text) {
        const std::string sha256 = sha256Hex(text);
        store[sha256] = text;
        return sha256;
    }
    BlobSource source() {
        return [this](const std::string& sha256, const std::filesystem::path& file) {
            ++fetches[sha256];
            if (!store.contains(sha256)) throw Error(ErrorCode::notFound, "no blob " + sha256);
            const bool rubbish = spoilt > 0 && spoilt--;
            std::ofstream(file, std::ios::binary) << (rubbish ? "rubbish" : store[sha256]);
        };
    }
    static std::string read(const std::filesystem::path& file) {
        std::ifstream in(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    std::filesystem::path blobFile(const std::string& sha256) {
        return folder / "cache" / "blobs" / sha256.substr(0, 2) / sha256;
    }

    TemporaryFolder folder;
    std::map<std::string, std::string> store;
    std::map<std::string, int> fetches;
    int spoilt = 0;  // that many of the next answers are rubbish
};

}  // namespace tilefarm
