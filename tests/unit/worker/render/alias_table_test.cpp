#include "worker/render/alias_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace tilefarm {
namespace {

// The probabilities that a table really has: threshold shares of each column, of the whole.
std::vector<double> probabilitiesOf(const std::vector<gpu::AliasRecord>& table) {
    std::vector<double> p(table.size());
    for (uint32_t i = 0; i < table.size(); ++i) {
        const double keep = table[i].alias == i ? 1 : table[i].threshold / 4294967296.0;
        p[i] += keep / double(table.size());
        p[table[i].alias] += (1 - keep) / double(table.size());
    }
    return p;
}

void expectProportional(const std::vector<double>& weights) {
    const auto table = buildAliasTable(weights);
    const auto p = probabilitiesOf(table);
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (size_t i = 0; i < weights.size(); ++i) {
        EXPECT_NEAR(p[i], weights[i] / total, 4e-10) << i;
        EXPECT_NEAR(table[i].pmf, weights[i] / total, 1e-7 * weights[i] / total + 1e-30) << i;
    }
}

TEST(AliasTable, DrawsEachEntryInProportionToItsWeight) {
    expectProportional({1});
    expectProportional({1, 2, 3, 4});
    expectProportional({0, 5, 0, 0, 1e-3});
}

TEST(AliasTable, HoldsForManyRandomWeights) {
    std::mt19937 random(1);
    std::vector<double> weights(5000);
    for (double& w : weights) w = std::exp(std::normal_distribution<>(0, 4)(random));
    expectProportional(weights);
}

TEST(AliasTable, NeverDrawsAnEntryOfWeightZero) {
    std::vector<double> weights(1000, 0.0);
    weights[3] = 1e-30;
    weights[997] = 0.1;
    const auto table = buildAliasTable(weights);
    for (uint32_t i = 0; i < table.size(); ++i) {
        if (weights[i] > 0) continue;
        EXPECT_EQ(table[i].threshold, 0u) << i;
        EXPECT_GT(weights[table[i].alias], 0) << i;
    }
}

TEST(AliasTable, KeepsTinyAndHugeWeightsFinite) {
    const auto table = buildAliasTable(std::vector<double>{1e-30, 1e30});
    EXPECT_NEAR(table[0].pmf, 0, 1e-37);
    EXPECT_FLOAT_EQ(table[1].pmf, 1);
}

}  // namespace
}  // namespace tilefarm
