#include "shared/farm_client/http_status.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tilefarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(HttpStatus, NamesWhatTheServerMeant) {
    EXPECT_EQ(errorCodeOf(400), ErrorCode::invalidArgument);
    EXPECT_EQ(errorCodeOf(401), ErrorCode::unauthorized);
    EXPECT_EQ(errorCodeOf(409), ErrorCode::conflict);
    EXPECT_EQ(errorCodeOf(410), ErrorCode::gone);
    EXPECT_EQ(errorCodeOf(414), ErrorCode::tooLarge);
    EXPECT_EQ(errorCodeOf(426), ErrorCode::versionRefused);
    EXPECT_EQ(errorCodeOf(503), ErrorCode::unavailable);
    EXPECT_EQ(errorCodeOf(507), ErrorCode::outOfSpace);
    EXPECT_EQ(errorCodeOf(502), ErrorCode::unavailable);
    EXPECT_EQ(errorCodeOf(302), ErrorCode::internal);
    EXPECT_EQ(errorCodeOf(418), ErrorCode::internal);
}

TEST(HttpStatus, TakesMessageAndFaultsFromTheProblem) {
    const Error error = errorOfAnswer(422, R"({"title":"t","detail":"two blobs are missing","errors":[
        {"pointer":"/scene/files/a","message":"is missing"},{"pointer":"/b","message":"m"}, 7, {"pointer":3}]})",
                                      "PUT x");
    EXPECT_EQ(error.code, ErrorCode::unprocessable);
    EXPECT_STREQ(error.what(), "two blobs are missing");
    EXPECT_THAT(error.faults,
                ElementsAre(Fault{"/scene/files/a", "is missing"}, Fault{"/b", "m"}, Fault{"", ""}));
    EXPECT_STREQ(errorOfAnswer(404, R"({"title":"No such job"})", "GET x").what(), "No such job");
}

TEST(HttpStatus, MakesASentenceWhereThereIsNoProblem) {
    for (const char* body : {"", "<html>Bad Gateway</html>", "[]", "{}", R"({"detail": 7})"})
        EXPECT_THAT(errorOfAnswer(502, body, "GET http://h/v1/jobs").what(),
                    testing::AllOf(HasSubstr("GET http://h/v1/jobs"), HasSubstr("502")));
}

TEST(PercentEncoded, KeepsUnreservedCharactersOnly) {
    EXPECT_EQ(percentEncoded("aZ09-._~"), "aZ09-._~");
    EXPECT_EQ(percentEncoded("a/b c?d=e&f%"), "a%2Fb%20c%3Fd%3De%26f%25");
    EXPECT_EQ(percentEncoded("ü"), "%C3%BC");
}

TEST(ContentDigest, IsBase64OfTheBytes) {
    // RFC 9530 has no example of the empty message; this is openssl dgst -sha256 -binary | base64.
    EXPECT_EQ(contentDigest("e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"),
              "sha-256=:47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=:");
}

}  // namespace
}  // namespace tilefarm
