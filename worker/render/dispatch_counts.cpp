#include "worker/render/dispatch_counts.h"

#include <cmath>

namespace tilefarm {
namespace {

double sumAt(std::span<const uint32_t> tile, uint32_t counter) {
    return exactSum(tile.subspan(counter, gpu::SUM_LIMBS));
}

}  // namespace

double exactSum(std::span<const uint32_t> limbs) {
    // In whole numbers first, so that nothing depends on how the limbs carry.
    uint64_t carry = 0, low = 0;
    double high = 0;
    for (size_t i = 0; i < limbs.size(); ++i) {
        const uint64_t limb = limbs[i] + carry;
        const uint64_t digit = limb & ((1u << gpu::SUM_LIMB_BITS) - 1);
        carry = limb >> gpu::SUM_LIMB_BITS;
        const auto shift = static_cast<int>(i * gpu::SUM_LIMB_BITS);
        if (shift + int{gpu::SUM_LIMB_BITS} <= 64)
            low |= digit << shift;
        else
            high += std::ldexp(static_cast<double>(digit), shift);
    }
    high += std::ldexp(static_cast<double>(carry), static_cast<int>(limbs.size() * gpu::SUM_LIMB_BITS));
    return std::ldexp(high + static_cast<double>(low), -32);
}

uint64_t DispatchCounts::rays() const {
    uint64_t sum = 0;
    for (size_t tile = 0; words(tile) < words_.size(); ++tile)
        sum += static_cast<uint64_t>(sumAt(ofTile(tile), gpu::TILE_RAYS));
    return sum;
}

void DispatchCounts::addTile(size_t tile, PassFaults& faults) const {
    const std::span<const uint32_t> counts = ofTile(tile);
    faults.rejectedPaths += counts[gpu::TILE_REJECTED];
    faults.truncatedPaths += counts[gpu::TILE_TRUNCATED];
    faults.truncatedThroughput += sumAt(counts, gpu::TILE_TRUNCATED_THROUGHPUT);
    faults.clampedSamples += counts[gpu::TILE_CLAMPED];
    faults.lightsBehindGlass += counts[gpu::TILE_BEHIND_GLASS];
    faults.clampedLuminance += sumAt(counts, gpu::TILE_CLAMPED_RADIANCE);
}

}  // namespace tilefarm
