#version 450 core
// variants: FURTHER=-,1
// What an iteration reports of all problems, a block of 16 x 16 a fragment: how many run, of how many the trial was accepted,
// and the sum of their errors, two floats. FURTHER: from blocks of such sums. Always in the same order.
#include "optimize/dialect.glsl"
#include "optimize/error_sum.glsl"
#ifdef FURTHER
uniform usampler2D source;
#else
uniform sampler2DArray source;  // the numbers of problems, as optimize/numbers.glsl
#endif
layout(location = 0) out uvec4 summary;
void main() {
    ivec2 first = ivec2(gl_FragCoord.xy) * 16, end = min(first + 16, textureSize(source, 0).xy);
    uvec2 counts = uvec2(0u);
    vec2 error = vec2(0.0);
    for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) {
#ifdef FURTHER
            uvec4 part = texelFetch(source, ivec2(x, y), 0);
            counts += part.xy;
            error = plus(error, uintBitsToFloat(part.zw));
#else
            error = plus(error, vec2(finite_error(texelFetch(source, ivec3(x, y, 0), 0).r), 0.0));
            vec4 rest = texelFetch(source, ivec3(x, y, 1), 0);
            counts += uvec2(rest.b == STATUS_ACTIVE, rest.g != 0.0);
#endif
        }
    summary = uvec4(counts, floatBitsToUint(error));
}
