#pragma once

#include <string>
#include <vector>

#include "server/cli/console.h"

namespace tilefarm {

/// The `tilefarm` program: parses the words after its name, does what they say, gives the exit code.
int runCli(const std::vector<std::string>& words, const Console& console);

}  // namespace tilefarm
