#pragma once

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <sstream>
#include <string>

namespace tilefarm {

/// Checks a property over that many random cases. The seed is RC_PARAMS' (fixed in CMakeLists.txt, so that CI
/// sees the same cases every time); a failure shows the case after shrinking and the words that make
/// RC_PARAMS run it again.
template <typename Testable>
void holds(const std::string& property, int cases, Testable&& testable) {
    rc::detail::TestParams params = rc::detail::configuration().testParams;
    params.maxSuccess = cases;
    rc::detail::TestMetadata metadata;
    metadata.id = metadata.description = property;
    const auto result = rc::detail::checkTestable(std::forward<Testable>(testable), metadata, params);
    std::ostringstream report;
    rc::detail::printResultMessage(result, report);
    EXPECT_TRUE(result.template is<rc::detail::SuccessResult>()) << property << ": " << report.str();
}

/// Stops a case with what is wrong of it.
inline void require(const std::string& faults) {
    if (!faults.empty()) RC_FAIL(faults);
}

}  // namespace tilefarm
