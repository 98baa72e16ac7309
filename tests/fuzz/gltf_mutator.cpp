// How libFuzzer changes glTF files: as JSON, as numbers in their buffer, and now and then as bytes.
#include <bit>
#include <cstring>

#include "tests/fuzz/gltf_container.h"
#include "tests/fuzz/gltf_words.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t mostBytes);

namespace {

using namespace tilefarm::fuzz;
using Bytes = std::vector<std::byte>;

uint8_t* raw(Bytes& bytes) {
    return reinterpret_cast<uint8_t*>(bytes.data());
}

std::span<const std::byte> spanOf(const uint8_t* data, size_t size) {
    return std::as_bytes(std::span(data, size));
}

// Numbers as geometry, indices and keys have them.
void overwrite(Bytes& bytes, JsonMutator& random) {
    constexpr uint32_t words[] = {0,
                                  1,
                                  3,
                                  4,
                                  255,
                                  256,
                                  65535,
                                  65536,
                                  0x7fffffff,
                                  0x80000000,
                                  0xffffffff,
                                  0x00010002,
                                  0x7f800000 /* inf */,
                                  0xff800000,
                                  0x7fc00000 /* NaN */,
                                  0x7f7fffff,
                                  0xff7fffff,
                                  0x00800000,
                                  0x00000001,
                                  0x3f800000,
                                  0xbf800000,
                                  0x60ad78ec /* 1e20 */,
                                  0x1e3ce508 /* 1e-20 */,
                                  0x3f000000};
    const uint32_t word = words[random.below(std::size(words))];
    const size_t width = size_t{1} << random.below(3);
    if (bytes.size() < width) return;
    const size_t at = random.below(bytes.size() / width) * width;
    std::memcpy(bytes.data() + at, &word, width);
}

void mutateBuffer(GltfContainer& file, JsonMutator& random, size_t mostBytes) {
    Bytes bytes = file.buffer();
    if (bytes.empty()) return file.setBuffer(Bytes(1 + random.below(64)));
    if (random.oneIn(2)) {
        for (size_t i = 0, n = 1 + random.below(4); i < n; ++i) overwrite(bytes, random);
    } else {
        const size_t size = bytes.size();
        bytes.resize(std::max(size, std::min(size + 64, mostBytes)));
        bytes.resize(LLVMFuzzerMutate(raw(bytes), size, bytes.size()));
    }
    file.setBuffer(bytes);
}

// 0 where it does not fit.
size_t give(const Bytes& bytes, uint8_t* data, size_t mostBytes) {
    if (bytes.empty() || bytes.size() > mostBytes) return 0;
    std::memcpy(data, bytes.data(), bytes.size());
    return bytes.size();
}

// Lengths in the header of a GLB and of its chunks that are not true.
void spoilLengths(Bytes& bytes, JsonMutator& random) {
    constexpr size_t places[] = {4, 8, 12, 16};
    const size_t at = places[random.below(std::size(places))];
    if (bytes.size() < at + 4) return;
    bytes[at + random.below(4)] = static_cast<std::byte>(random.below(256));
}

}  // namespace

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t mostBytes, unsigned int seed) {
    JsonMutator random(seed, kGltfWords);
    auto file = random.oneIn(8) ? std::nullopt : GltfContainer::parse(spanOf(data, size));
    if (!file) return LLVMFuzzerMutate(data, size, mostBytes);
    if (random.oneIn(4)) {
        mutateBuffer(*file, random, mostBytes);
    } else {
        for (size_t i = 0, n = 1 + random.below(3); i < n; ++i) random.mutate(file->json);
    }
    if (random.oneIn(24)) file->turnIntoOther();
    Bytes bytes = file->bytes();
    if (file->glb && random.oneIn(16)) spoilLengths(bytes, random);
    const size_t given = give(bytes, data, mostBytes);
    return given ? given : LLVMFuzzerMutate(data, size, mostBytes);
}

extern "C" size_t LLVMFuzzerCustomCrossOver(const uint8_t* a, size_t aSize, const uint8_t* b, size_t bSize,
                                            uint8_t* out, size_t mostBytes, unsigned int seed) {
    JsonMutator random(seed, kGltfWords);
    auto first = GltfContainer::parse(spanOf(a, aSize));
    const auto second = GltfContainer::parse(spanOf(b, bSize));
    if (!first || !second) return 0;
    random.cross(first->json, second->json);
    return give(first->bytes(), out, mostBytes);
}
