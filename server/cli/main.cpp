#include <unistd.h>

#include <iostream>
#include <thread>

#include "server/cli/cli.h"

int main(int argc, char** argv) {
    const tilefarm::SystemClock clock;
    const tilefarm::Console console{std::cout, std::cerr, isatty(STDERR_FILENO) == 1, clock,
                                    [](tilefarm::Milliseconds time) { std::this_thread::sleep_for(time); }};
    return tilefarm::runCli({argv + 1, argv + argc}, console);
}
