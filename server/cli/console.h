#pragma once

#include <functional>
#include <iosfwd>

#include "shared/clock/clock.h"

namespace tilefarm {

/// Where the commands speak and wait. What another program may want to read goes to `out` (the id of
/// a submitted job, tables, JSON), all else to `err`.
struct Console {
    std::ostream& out;
    std::ostream& err;
    bool terminal = false;  // err is one that understands a carriage return
    const Clock& clock;
    std::function<void(Milliseconds)> sleep;
};

/// What the program exits with.
enum ExitCode { kDone = 0, kFailed = 1, kUsage = 2, kUnreachable = 3 };

}  // namespace tilefarm
