#version 450 core
// variants: FURTHER=-,1 WHOLE_BLOCKS=-,1
// What an iteration reports of all problems, a block of 16 x 16 a fragment: how many run, of how many the trial was accepted,
// and the sum of their errors, two floats. FURTHER: from blocks of such sums. Always in the same order.
// WHOLE_BLOCKS: loops of constant length, 16 look-ups a fragment; what lies beyond the rim is left out of the sum.
#include "optimize/dialect.glsl"
#include "optimize/error_sum.glsl"
#ifdef FURTHER
uniform usampler2D source;
#else
uniform sampler2DArray source;  // the numbers of problems, as optimize/numbers.glsl
#endif
layout(location = 0) out uvec4 summary;

#ifndef WHOLE_BLOCKS
const ivec2 block = ivec2(16);
#elif defined(FURTHER)
const ivec2 block = ivec2(4);
#else
const ivec2 block = ivec2(4, 2);  // of two look-ups each
#endif

void add(ivec2 at, bool inside, inout uvec2 counts, inout vec2 error) {
#ifdef FURTHER
    uvec4 part = texelFetch(source, at, 0);
    counts += inside ? part.xy : uvec2(0u);
    error = plus(error, inside ? uintBitsToFloat(part.zw) : vec2(0.0));
#else
    float of_one = texelFetch(source, ivec3(at, 0), 0).r;
    error = plus(error, vec2(inside ? finite_error(of_one) : 0.0, 0.0));
    vec4 rest = texelFetch(source, ivec3(at, 1), 0);
    counts += uvec2(inside && rest.b == STATUS_ACTIVE, inside && rest.g != 0.0);
#endif
}

void main() {
    ivec2 size = textureSize(source, 0).xy, first = ivec2(gl_FragCoord.xy) * block;
    uvec2 counts = uvec2(0u);
    vec2 error = vec2(0.0);
#ifdef WHOLE_BLOCKS
    for (int i = 0; i < block.x * block.y; ++i) {
        ivec2 at = first + ivec2(i % block.x, i / block.x);
        bool inside = all(lessThan(at, size));
        add(inside ? at : first, inside, counts, error);
    }
#else
    ivec2 end = min(first + block, size);
    for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) add(ivec2(x, y), true, counts, error);
#endif
    summary = uvec4(counts, floatBitsToUint(error));
}
