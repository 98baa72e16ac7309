#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "shared/error/error.h"

namespace tilefarm {

/// The Error that `work` throws; a test failure if it throws none.
inline Error errorOf(const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no Error was thrown";
    return {ErrorCode::internal, "no Error was thrown"};
}

/// The code `work` fails with.
inline ErrorCode codeOf(const std::function<void()>& work) { return errorOf(work).code; }

}  // namespace tilefarm
