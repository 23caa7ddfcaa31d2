// Texel-local models in buffers: an invocation is a texel and fits it alone. Samples stay on the device, those that count
// (model/texel_options.h): texels in blocks of LANES, the samples of a block row by row, one of each texel in a row.
#include "reflect/parameters.glsl"
#include "reflect/sample.glsl"
#include "reflect/bounds.glsl"
layout(local_size_x = LANES) in;
uniform int texel_count;
uniform int surface_width;
uniform usamplerBuffer texels;        // [texel] its place in `surface`; samples; [LANES first of a block] where its rows begin
uniform usamplerBuffer texel_samples; // colour in 16-bit units and image; WIDE: three floats and image
layout(std430) readonly buffer Numbers { float numbers[]; };  // [problem][NUMBER_COUNT]
layout(std430) buffer Problems { vec4 problems[]; };          // [texel] E_t; two sums along d

uint texel_index() {
    return (gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * uint(LANES) + gl_LocalInvocationID.x;
}
float number_of(int number) { return numbers[texel_index() * uint(NUMBER_COUNT) + uint(number)]; }
bool is_active() { return texel_index() < uint(texel_count) && number_of(NUMBER_STATUS) == STATUS_ACTIVE; }
bool is_alive() { return is_active() || (texel_index() < uint(texel_count) && number_of(NUMBER_ACCEPTED) != 0.0); }

// Element `map` of the texel in a vector, three numbers.
uint element_index(int map) { return uint(map) * uint(texel_count) + texel_index(); }
Parameters fetch_parameters(samplerBuffer vector) {
    Parameters p;
    for (int k = 0; k < BASIS_COUNT; ++k) p.a[k] = texelFetch(vector, int(element_index(k))).rgb;
    p.shape.x[0] = 0.0;
    for (int j = 0; j < SHAPE_MAPS; ++j) {
        vec3 three = texelFetch(vector, int(element_index(BASIS_COUNT + j))).rgb;
        for (int c = 0; c < 3; ++c)
            if (3 * j + c < SHAPE_COUNT) p.shape.x[3 * j + c] = three[c];
    }
    return p;
}

struct Samples {
    uint first, stride, count;
    Site site;
};
Samples samples_of_texel() {
    uvec4 row = texelFetch(texels, int(texel_index()));
    return Samples(row.z, row.w, row.y, site_at(ivec2(int(row.x) % surface_width, int(row.x) / surface_width)));
}
Sample sample_at(Samples all, uint i) {
#ifdef WIDE
    uvec4 words = texelFetch(texel_samples, int(all.first + i * all.stride));
    Sample s = sample_of(view_at(3 * int(words.w)), all.site, uintBitsToFloat(words.xyz));
#else
    uvec2 words = texelFetch(texel_samples, int(all.first + i * all.stride)).rg;
    Sample s = sample_of(view_at(3 * int(words.y >> 16)), all.site,
                         vec3(uvec3(words.x & 0xffffu, words.x >> 16, words.y & 0xffffu)));
#endif
    s.counts = true;  // it was looked into when it was put here
    return s;
}
