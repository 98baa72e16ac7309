#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace tilefarm {

/// SHA-256 over bytes that arrive in pieces.
class Sha256 {
public:
    Sha256();
    ~Sha256();
    Sha256(Sha256&&) noexcept;
    Sha256& operator=(Sha256&&) noexcept;
    void update(std::span<const std::byte> bytes);
    /// 64 lower-case hex digits. Ends this digest: no update may follow.
    std::string finishHex();

private:
    struct State;
    std::unique_ptr<State> state_;
};

std::string sha256Hex(std::span<const std::byte> bytes);
std::string sha256Hex(std::string_view bytes);
/// Throws Error(notFound) that names the file if it cannot be read.
std::string sha256OfFile(const std::filesystem::path& path);
/// True for 64 lower-case hex digits.
bool isSha256Hex(std::string_view text);

}  // namespace tilefarm
