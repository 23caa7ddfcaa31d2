#version 450 core
// variants: LANES=32,64,128
// A pass over samples as the engines have them, made up: what decides which size of work group a device likes. Each group has
// `items` work items (texels of a tile), each with samples that look up a value, and sums what its items have.
layout(local_size_x = LANES) in;
uniform usamplerBuffer words;  // of samples: in blocks of LANES items, row by row, one of each item in a row
uniform samplerBuffer values;
uniform int items, samples_each, value_mask;
layout(std430) writeonly buffer Sums { vec4 sums[]; };
shared vec4 parts[LANES];
void main() {
    uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x, lane = gl_LocalInvocationID.x;
    vec4 sum = vec4(0.0);
    for (uint i = lane; i < uint(items); i += uint(LANES)) {
        uint begin = i - lane, width = min(uint(LANES), uint(items) - begin);
        uint first = (group * uint(items) + begin) * uint(samples_each) + lane;
        vec3 g = vec3(0.5), slope = vec3(0.0), squares = vec3(0.0);
        for (uint s = 0u; s < uint(samples_each); ++s) {
            uint word = texelFetch(words, int(first + s * width)).r;
            vec3 colour = vec3(word & 0xffu, word >> 8 & 0xffu, word >> 16 & 0xffu) * (1.0 / 255.0);
            for (uint corner = 0u; corner < 3u; ++corner) {
                vec4 value = texelFetch(values, int((word + corner * 977u) & uint(value_mask)));
                vec3 r = g * value.xyz - value.w * colour;
                slope += r * value.xyz;
                squares += value.xyz * value.xyz;
            }
        }
        sum += vec4(slope + squares, dot(slope, slope));
    }
    parts[lane] = sum;
    for (uint half_size = uint(LANES) / 2u; half_size > 0u; half_size /= 2u) {
        barrier();
        if (lane < half_size) parts[lane] += parts[lane + half_size];
    }
    if (lane == 0u) sums[group] = parts[0];
}
