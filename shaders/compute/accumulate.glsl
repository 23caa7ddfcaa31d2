// Sums that any invocation adds to (scatter), three channels side by side. ACCUMULATE says how. Each way is macros, for
// no function takes a storage block: SUM_WORD and SUM_WORDS, what one channel's sum is stored in; ADD_ONE, SUM_ONE and
// CLEAR_ONE, which add to it, read it and make it zero.
#define FIXED 1    // fixed point, whole numbers: they add up to the same bits in any order
#define FLOAT 2    // floats, by the driver's atomic addition: rounding depends on the order
#define SWAPPED 3  // floats, where the driver has none, by comparing and swapping: rounding depends on the order
#ifndef ACCUMULATE
#define ACCUMULATE FIXED
#endif
#if ACCUMULATE == FIXED
// Signed fixed point of 64 bits in two words, the lower first: a number times its scale, a power of two by which no sum
// exceeds 2^61 (scales.comp). A scale of 0: there is none, for numbers aren't finite, and neither are sums.
uvec2 fixed_of(float value, float scale) {
    float x = scale > 0.0 ? roundEven(value * scale) : 0.0, size = abs(x);
    uint high = uint(size * (1.0 / 4294967296.0)), low = uint(size - float(high) * 4294967296.0);  // of 24 bits: exact
    return x < 0.0 ? uvec2(~low + 1u, ~high + uint(low == 0u)) : uvec2(low, high);
}
float number_of(uvec2 words, float scale) {
    bool negative = words.y > 0x7fffffffu;
    uvec2 size = negative ? uvec2(~words.x + 1u, ~words.y + uint(words.x == 0u)) : words;
    float x = float(size.y) * 4294967296.0 + float(size.x);
    return scale > 0.0 ? (negative ? -x : x) / scale : uintBitsToFloat(0x7f800000u);
}
#define SUM_WORD uint
#define SUM_WORDS 2
#define ADD_ONE(sums, i, value, scale) \
    { \
        uvec2 words = fixed_of(value, scale); \
        uint before = atomicAdd(sums[0].x[i], words.x), upper = words.y + uint(before > ~words.x); \
        if (upper != 0u) atomicAdd(sums[1].x[i], upper); \
    }
#define SUM_ONE(sums, i, scale) number_of(uvec2(sums[0].x[i], sums[1].x[i]), scale)
#define CLEAR_ONE(sums, i) sums[0].x[i] = sums[1].x[i] = 0u
#elif ACCUMULATE == FLOAT
#extension GL_NV_shader_atomic_float : require
#define SUM_WORD float
#define SUM_WORDS 1
#define ADD_ONE(sums, i, value, scale) atomicAdd(sums[0].x[i], value);
#define SUM_ONE(sums, i, scale) sums[0].x[i]
#define CLEAR_ONE(sums, i) sums[0].x[i] = 0.0
#else
#define SUM_WORD uint
#define SUM_WORDS 1
#define ADD_ONE(sums, i, value, scale) \
    { \
        uint seen = sums[0].x[i], expected; \
        do { \
            expected = seen; \
            seen = atomicCompSwap(sums[0].x[i], expected, floatBitsToUint(uintBitsToFloat(expected) + value)); \
        } while (seen != expected); \
    }
#define SUM_ONE(sums, i, scale) uintBitsToFloat(sums[0].x[i])
#define CLEAR_ONE(sums, i) sums[0].x[i] = 0u
#endif

// The same for three channels.
#define ADD(sums, i, value, scale) \
    { \
        vec3 added = value, by = scale; \
        uint first = 3u * (i); \
        for (int channel = 0; channel < 3; ++channel) ADD_ONE(sums, first + uint(channel), added[channel], by[channel]) \
    }
#define SUM(sums, i, scale) \
    vec3(SUM_ONE(sums, 3u * (i), (scale).x), SUM_ONE(sums, 3u * (i) + 1u, (scale).y), \
         SUM_ONE(sums, 3u * (i) + 2u, (scale).z))
#define CLEAR(sums, i) \
    for (uint channel = 0u; channel < 3u; ++channel) { CLEAR_ONE(sums, 3u * (i) + channel); }

// The includer says which sums there are.
#ifdef WITH_ELEMENTS  // [element of maps][channel]: gradients; of view maps once cameras' views of vertices are spread
layout(std430) coherent buffer ElementSums { SUM_WORD x[]; } element_sums[SUM_WORDS];
#ifdef DIAGONAL
layout(std430) coherent buffer ElementSquares { SUM_WORD x[]; } element_squares[SUM_WORDS];
#endif
#endif
#ifdef WITH_PAIRS  // [pair][term][channel]: what a camera's view of a vertex adds to its view map
layout(std430) coherent buffer PairSums { SUM_WORD x[]; } pair_sums[SUM_WORDS];
#ifdef DIAGONAL
layout(std430) coherent buffer PairSquares { SUM_WORD x[]; } pair_squares[SUM_WORDS];
#endif
#endif
#ifdef WITH_CORNERS  // [tile][corner][TILE_SUMS][channel]
layout(std430) coherent buffer CornerSums { SUM_WORD x[]; } corner_sums[SUM_WORDS];
#endif

#include "compute/scales.glsl"
#if ACCUMULATE == FIXED
uniform samplerBuffer scales;  // [vertex][SCALES]
vec3 scale_of(uint vertex, int what) { return texelFetch(scales, int(vertex) * SCALES + what).xyz; }
#else
vec3 scale_of(uint vertex, int what) { return vec3(1.0); }
#endif
