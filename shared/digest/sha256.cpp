#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <new>
#include <vector>

#include "shared/digest/digest.h"
#include "shared/error/error.h"

namespace tilefarm {

namespace {

// OpenSSL reports only want of memory or a broken installation here.
void require(int ok) {
    if (ok != 1) throw Error(ErrorCode::internal, "OpenSSL could not compute a SHA-256");
}

}  // namespace

struct Sha256::State {
    EVP_MD_CTX* context = EVP_MD_CTX_new();

    State() {
        if (!context) throw std::bad_alloc();
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() { EVP_MD_CTX_free(context); }
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
    require(EVP_DigestInit_ex(state_->context, EVP_sha256(), nullptr));
}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

void Sha256::update(std::span<const std::byte> bytes) {
    require(EVP_DigestUpdate(state_->context, bytes.data(), bytes.size()));
}

std::string Sha256::finishHex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    require(EVP_DigestFinal_ex(state_->context, digest.data(), &size));

    constexpr std::string_view digits = "0123456789abcdef";
    std::string hex;
    hex.reserve(size * 2);
    for (unsigned int i = 0; i < size; ++i) {
        hex += digits[digest[i] >> 4];
        hex += digits[digest[i] & 15];
    }
    return hex;
}

std::string sha256Hex(std::span<const std::byte> bytes) {
    Sha256 digest;
    digest.update(bytes);
    return digest.finishHex();
}

std::string sha256Hex(std::string_view bytes) {
    return sha256Hex(std::as_bytes(std::span(bytes.data(), bytes.size())));
}

std::string sha256OfFile(const std::filesystem::path& path) {
    // A folder opens as a stream but does not read.
    std::ifstream file(path, std::ios::binary);
    if (!file || std::filesystem::is_directory(path))
        throw Error(ErrorCode::notFound, "cannot read '" + path.string() + "'");

    Sha256 digest;
    std::vector<char> block(256 * 1024);
    while (file) {
        file.read(block.data(), static_cast<std::streamsize>(block.size()));
        digest.update(std::as_bytes(std::span(block.data(), static_cast<size_t>(file.gcount()))));
    }
    if (file.bad()) throw Error(ErrorCode::notFound, "reading '" + path.string() + "' failed");
    return digest.finishHex();
}

bool isSha256Hex(std::string_view text) {
    return text.size() == 64 && std::all_of(text.begin(), text.end(), [](char c) {
               return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
           });
}

}  // namespace tilefarm
