// How libFuzzer changes jobs: as JSON, and now and then as bytes.
#include <cstring>

#include "tests/fuzz/job_words.h"
#include "tests/fuzz/json_mutator.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t mostBytes);

namespace {

using namespace tilefarm;
using fuzz::Json;
using fuzz::JsonMutator;

std::span<const std::string_view> vocabulary() {
    static const std::vector<std::string> words = fuzz::jobWords();
    static const std::vector<std::string_view> views(words.begin(), words.end());
    return views;
}

size_t give(const Json& document, uint8_t* data, size_t mostBytes) {
    const std::string text = fuzz::textOf(document);
    if (text.size() > mostBytes) return 0;
    std::memcpy(data, text.data(), text.size());
    return text.size();
}

Json parse(const uint8_t* data, size_t size) {
    return Json::parse(data, data + size, nullptr, false);
}

}  // namespace

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t mostBytes, unsigned int seed) {
    JsonMutator random(seed, vocabulary());
    Json document = random.oneIn(8) ? Json() : parse(data, size);
    if (!document.is_object()) return LLVMFuzzerMutate(data, size, mostBytes);
    for (size_t i = 0, n = 1 + random.below(3); i < n; ++i) random.mutate(document);
    const size_t given = give(document, data, mostBytes);
    return given ? given : LLVMFuzzerMutate(data, size, mostBytes);
}

extern "C" size_t LLVMFuzzerCustomCrossOver(const uint8_t* a, size_t aSize, const uint8_t* b, size_t bSize,
                                            uint8_t* out, size_t mostBytes, unsigned int seed) {
    JsonMutator random(seed, vocabulary());
    Json first = parse(a, aSize);
    const Json second = parse(b, bSize);
    if (!first.is_object() || second.is_discarded()) return 0;
    random.cross(first, second);
    return give(first, out, mostBytes);
}
