#include "tests/unit/server/api/api_fixture.h"

#include <openssl/evp.h>

#if defined(__SANITIZE_THREAD__)
// The HTTP library comes without instrumentation: the guard of its local statics is not seen.
extern "C" const char* __tsan_default_suppressions() {
    return "called_from_lib:libcpp-httplib.so\n";
}
#endif

namespace tilefarm {
namespace {

std::string bytesOfHex(const std::string& hex) {
    std::string bytes;
    for (size_t i = 0; i < hex.size(); i += 2)
        bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
    return bytes;
}

}  // namespace

std::string ApiTest::contentDigest(const std::string& body) {
    const std::string bytes = bytesOfHex(sha256Hex(body));
    unsigned char text[64];
    EVP_EncodeBlock(text, reinterpret_cast<const unsigned char*>(bytes.data()),
                    static_cast<int>(bytes.size()));
    return "sha-256=:" + std::string(reinterpret_cast<const char*>(text)) + ":";
}

std::string ApiTest::encoded(const Lease& lease) {
    const auto bytes = encodePassFilms(renderLease(lease), lease.spec.image, {});
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

httplib::Result ApiTest::upload(const Lease& lease, const std::string& extra) {
    const std::string body = encoded(lease);
    const std::string path =
        "/v1/leases/" + lease.id + "/result?deviceSeconds=1.5&epoch=" + std::to_string(lease.epoch);
    return client.Put(path.c_str(), {{"Content-Digest", contentDigest(body)}}, body + extra, "image/x-exr");
}

}  // namespace tilefarm
