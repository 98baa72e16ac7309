// libFuzzer: whatever JSON comes, job, lease and hello are read whole or refused with an Error, and what is
// read survives being written.
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "shared/error/error.h"
#include "shared/job/wire.h"

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

}  // namespace

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
