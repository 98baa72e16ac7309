#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "shared/film/film.h"

/// What the suite asks of numbers that carry noise.
namespace tilefarm {

/// Statistical comparisons that the suite makes, rounded up; what the Šidák correction counts.
inline constexpr int kSuiteComparisons = 1024;
/// Chance that a right renderer fails the suite somewhere; seeds are fixed, so it fails always or never.
inline constexpr double kSuiteSignificance = 0.02;

/// Two-sided tail of the normal distribution beyond z.
inline double normalTail(double z) {
    return std::erfc(z / std::numbers::sqrt2);
}

/// The z beyond which one comparison of the suite fails: 1 − (1 − significance)^(1/n) of Šidák 1967, by
/// bisection. 4.27 for the two numbers above, where HARD-CASES.md says "4σ with a Šidák correction".
inline double zLimit() {
    const double each = 1 - std::pow(1 - kSuiteSignificance, 1.0 / kSuiteComparisons);
    double low = 0, high = 10;
    for (int i = 0; i < 60; ++i) (normalTail((low + high) / 2) > each ? low : high) = (low + high) / 2;
    return high;
}

/// Keeps the largest value of a test in its XML report (--gtest_output=xml): the figures of README.md.
inline void recordWorst(const std::string& key, double value) {
    static std::map<std::string, double> worst;
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    if (!test || !std::isfinite(value)) return;
    double& most = worst.try_emplace(std::string(test->name()) + key, value).first->second;
    most = std::max(most, value);
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", most);
    testing::Test::RecordProperty(key, text);
}

struct Mean {
    double value = 0, sigma = 0;  // sigma: standard deviation of `value`
};

/// |mean − expected| ≤ z σ. `slack`: what the scene itself is off, such as a sphere of triangles.
inline void expectMean(const Mean& mean, double expected, double slack = 0) {
    // A mean without noise is still a float's.
    const double rounding = 1e-6 * (std::abs(expected) + 1e-30);
    if (mean.sigma > 0) recordWorst("z", std::abs(mean.value - expected) / mean.sigma);
    if (expected != 0) recordWorst("relative", std::abs(mean.value - expected) / std::abs(expected));
    EXPECT_NEAR(mean.value, expected, zLimit() * mean.sigma + slack + rounding) << "sigma " << mean.sigma;
}

/// Two independent estimates of one number.
inline void expectSameMean(const Mean& a, const Mean& b, double slack = 0) {
    expectMean({a.value - b.value, std::hypot(a.sigma, b.sigma)}, 0, slack + 1e-6 * std::abs(a.value));
}

/// p-value of a χ² statistic: the regularised incomplete gamma function Q(degrees / 2, statistic / 2), by its
/// series or by Lentz's continued fraction (Press et al., Numerical Recipes, 6.2). Relative error ≤ 1e-9.
inline double chiSquareTail(double statistic, double degrees) {
    const double a = degrees / 2, x = statistic / 2;
    if (!(x > 0)) return 1;
    const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double n = a + 1; term > 1e-12 * sum; ++n) sum += term *= x / n;
        return 1 - front * sum;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
    for (int n = 1; n < 10'000; ++n) {
        const double an = -n * (n - a);
        b += 2;
        d = 1 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-12) break;
    }
    return front * h;
}

/// Observed counts against expected ones; bins that expect less than five are pooled.
inline void expectChiSquare(const std::vector<double>& observed, const std::vector<double>& expected) {
    ASSERT_EQ(observed.size(), expected.size());
    double statistic = 0, pooledObserved = 0, pooledExpected = 0;
    int bins = 0;
    const auto add = [&](double o, double e) {
        statistic += (o - e) * (o - e) / e;
        ++bins;
    };
    for (size_t i = 0; i < observed.size(); ++i) {
        if (expected[i] == 0) {
            ASSERT_EQ(observed[i], 0) << "bin " << i << " must stay empty";
        } else if (expected[i] < 5) {
            pooledObserved += observed[i];
            pooledExpected += expected[i];
        } else {
            add(observed[i], expected[i]);
        }
    }
    if (pooledExpected >= 5) add(pooledObserved, pooledExpected);
    ASSERT_GT(bins, 1);
    recordWorst("chi2_per_degree", statistic / (bins - 1));
    EXPECT_GT(chiSquareTail(statistic, bins - 1), normalTail(zLimit())) << statistic << " over " << bins;
}

}  // namespace tilefarm
