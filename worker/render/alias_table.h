#pragma once

#include <span>
#include <vector>

#include "shaders/gpu_types.h"

namespace tilefarm {

/// Walker's alias method over `weights` (any finite values ≥ 0, at least one positive): entry i is
/// drawn with probability weights[i] / Σ weights, in constant time from two 32-bit numbers. Sums in
/// double; thresholds are rounded to 2^-32, so a probability is off by at most 2^-32 / n.
/// `pmf` holds the probability in fp32. Entries of weight 0 are never drawn.
/// Vose 1991, A linear algorithm for generating random numbers with a given distribution.
std::vector<gpu::AliasRecord> buildAliasTable(std::span<const double> weights);

}  // namespace tilefarm
