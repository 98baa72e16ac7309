// What a dispatch counts, for its report: sums over all invocations of a tile that come out the same to the bit in
// whatever order the device adds. So floats are summed in fixed point. Subgroups add up first: a million invocations
// that go for one word by themselves cost an NVIDIA H200 up to twenty times the rendering.
#ifndef COUNTERS_GLSL
#define COUNTERS_GLSL

#include "gpu_types.h"

// A sum of numbers from 0 to EXACT_SUM_LARGEST, rounded down to multiples of 2^-32; no more than 2^32 - 2^-32.
struct ExactSum {
    uint whole, fraction;
};

void add(inout ExactSum sum, float value) {
    // Each step is exact: the difference has no more bits than the value, and the product moves its exponent alone.
    // (Infinity and NaN fail the comparison.)
    float bounded = value < EXACT_SUM_LARGEST ? max(value, 0.0) : EXACT_SUM_LARGEST;
    precise float below = bounded - floor(bounded);
    precise float scaled = below * 4294967296.0;
    uint carry, overflow;
    sum.fraction = uaddCarry(sum.fraction, uint(scaled), carry);
    sum.whole = uaddCarry(sum.whole, uint(floor(bounded)) + carry, overflow);
    if (overflow != 0u) sum = ExactSum(0xffffffffu, 0xffffffffu);
}

// The invocations that are active here add to a counter of the buffer.
void addToCounter(uint counter, uint value) {
    uint sum = subgroupAdd(value);
    if (subgroupElect() && sum != 0u) atomicAdd(counters[counter], sum);
}

// Likewise to SUM_LIMBS words, which need no carries: 2^20 invocations, a tile at its largest, add SUM_LIMB_BITS each.
void addToCounter(uint counter, ExactSum sum) {
    const uint mask = (1u << SUM_LIMB_BITS) - 1u;
    addToCounter(counter, sum.fraction & mask);
    addToCounter(counter + 1u, sum.fraction >> 12u & mask);
    addToCounter(counter + 2u, (sum.fraction >> 24u | sum.whole << 8u) & mask);
    addToCounter(counter + 3u, sum.whole >> 4u & mask);
    addToCounter(counter + 4u, sum.whole >> 16u & mask);
    addToCounter(counter + 5u, sum.whole >> 28u);
}

#endif
