// Samplers that spread the samples of a pixel more evenly than independent ones: every block of four dimensions
// has its own point set, so blocks stay independent of each other (padding). All are pure functions of the key,
// and each number by itself is uniform, so no estimate is biased at any number of samples.
#ifndef SAMPLER_GLSL
#define SAMPLER_GLSL

// Hash in which a bit depends on lower bits alone (Laine, Karras 2011, with Vegdahl's constants): a nested uniform
// (Owen) scramble of a number whose bits are reversed.
uint laineKarras(uint x, uint seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// Direction numbers of the second to fourth Sobol dimension (Joe, Kuo 2008), with their bits reversed; those of the
// first are 1 << i.
const uint SOBOL_REVERSED[3][16] = uint[3][16](
    uint[16](0x0001u, 0x0003u, 0x0005u, 0x000fu, 0x0011u, 0x0033u, 0x0055u, 0x00ffu,
             0x0101u, 0x0303u, 0x0505u, 0x0f0fu, 0x1111u, 0x3333u, 0x5555u, 0xffffu),
    uint[16](0x0001u, 0x0003u, 0x0006u, 0x0009u, 0x0017u, 0x003au, 0x0071u, 0x00a3u,
             0x0116u, 0x0339u, 0x0677u, 0x09aau, 0x1601u, 0x3903u, 0x7706u, 0xaa09u),
    uint[16](0x0001u, 0x0003u, 0x0004u, 0x000au, 0x001fu, 0x002eu, 0x0045u, 0x00c9u,
             0x011bu, 0x02a4u, 0x079au, 0x0b67u, 0x101eu, 0x302du, 0x4041u, 0xa0c3u)
);

// Burley, Practical Hash-based Owen Scrambling, JCGT 2020: Sobol points in shuffled order, each dimension scrambled.
// Sets of 2^16 points follow each other, scrambled anew.
uvec4 sobolBits(SampleKey key, uint dimension) {
    uvec4 seeds = pcg4d(uvec4(key.pixel, key.index >> 16u, dimension, key.stream ^ 0x736f626fu));
    uint reversed = bitfieldReverse(key.index) >> 16u;
    uint index = bitfieldReverse(laineKarras(reversed, seeds.x)) >> 16u;
    uvec4 point = uvec4(index, 0u, 0u, 0u);
    for (uint i = 0u; i < 16u; i++) {
        uint set = 0u - (index >> i & 1u);
        point.yzw ^= set & uvec3(SOBOL_REVERSED[0][i], SOBOL_REVERSED[1][i], SOBOL_REVERSED[2][i]);
    }
    uint last = seeds.x * 747796405u + 2891336453u;
    return uvec4(bitfieldReverse(laineKarras(point.x, seeds.y)), bitfieldReverse(laineKarras(point.y, seeds.z)),
                 bitfieldReverse(laineKarras(point.z, seeds.w)), bitfieldReverse(laineKarras(point.w, last)));
}

// A permutation of 0 … n − 1 chosen by `seed` (Kensler, Correlated Multi-Jittered Sampling, 2013).
uint permuted(uint i, uint n, uint seed) {
    uint w = n - 1u;
    w |= w >> 1u;
    w |= w >> 2u;
    w |= w >> 4u;
    w |= w >> 8u;
    w |= w >> 16u;
    do {
        i ^= seed;
        i *= 0xe170893du;
        i ^= seed >> 16u;
        i ^= (i & w) >> 4u;
        i ^= seed >> 8u;
        i *= 0x0929eb3fu;
        i ^= seed >> 23u;
        i ^= (i & w) >> 1u;
        i *= 1u | seed >> 27u;
        i *= 0x6935fa69u;
        i ^= (i & w) >> 11u;
        i *= 0x74dcb303u;
        i ^= (i & w) >> 2u;
        i *= 0x9e501cc3u;
        i ^= (i & w) >> 2u;
        i *= 0xc860a3dfu;
        i &= w;
        i ^= i >> 5u;
    } while (i >= n);
    return (i + seed) % n;
}

// Where `bits` fall within stratum `index` of `side` equal ones.
uint withinStratum(uint index, uint side, uint bits) {
    uint width = 0xffffffffu / side, high, low;
    umulExtended(bits, width, high, low);
    return index * width + high;
}

// Both pairs of a block on a jittered grid of side² cells, in an order of their own; grids follow each other.
uvec4 stratifiedBits(SampleKey key, uint dimension) {
    uint side = parameters.strata, cells = side * side;
    uint grid = key.index / cells, i = key.index - grid * cells;
    uvec4 bits = independentBits(key, dimension);
    uvec4 seeds = pcg4d(uvec4(key.pixel, grid, dimension, key.stream ^ 0x73747261u));
    uint a = permuted(i, cells, seeds.x), b = permuted(i, cells, seeds.y);
    return uvec4(withinStratum(a % side, side, bits.x), withinStratum(a / side, side, bits.y),
                 withinStratum(b % side, side, bits.z), withinStratum(b / side, side, bits.w));
}

#endif
