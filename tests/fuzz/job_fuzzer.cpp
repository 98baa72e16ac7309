// libFuzzer: whatever JSON comes, job, lease and hello are read whole or refused with an Error, and what is
// read survives being written. How JSON is changed: job_mutator.cpp.
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "shared/error/error.h"
#include "shared/job/wire.h"
#include "tests/fuzz/job_words.h"

namespace {

using namespace tilefarm;
using nlohmann::json;

template <typename Read>
void readAndWrite(const json& source, ErrorCode refusal, const Read& read) {
    try {
        const auto value = read(source);
        const json written = toJson(value);
        if (toJson(read(written)) != written) std::abort();
    } catch (const Error& error) {
        if (error.code != refusal) std::abort();
    }
}

void collectWords(const json& schema, std::set<std::string>& words) {
    if (schema.is_object())
        for (const auto& [key, value] : schema.items()) {
            if (key == "properties")
                for (const auto& [name, member] : value.items()) words.insert(name);
            if (key == "enum")
                for (const json& word : value)
                    if (word.is_string()) words.insert(word.get<std::string>());
            collectWords(value, words);
        }
    if (schema.is_array())
        for (const json& item : schema) collectWords(item, words);
}

}  // namespace

std::vector<std::string> tilefarm::fuzz::jobWords() {
    std::set<std::string> words{"../x",   "a.gltf", std::string(64, 'a'), "id", "jobId", "spec",
                                "passes", "epoch"};
    collectWords(jobSchema(), words);
    return {words.begin(), words.end()};
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    json source;
    try {
        source = parseJson({reinterpret_cast<const char*>(data), size});
    } catch (const Error& error) {
        if (error.code != ErrorCode::invalidArgument) std::abort();
        return 0;
    }
    readAndWrite(source, ErrorCode::invalidArgument, jobFromJson);
    readAndWrite(source, ErrorCode::invalidArgument, leaseFromJson);
    readAndWrite(source, ErrorCode::invalidArgument, helloFromJson);
    return 0;
}
