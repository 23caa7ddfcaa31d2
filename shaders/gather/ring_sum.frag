#version 450 core
// One level of the gather over the triangle rings: a node sums up to 12 entries, whose places three look-ups into a
// table give (15 look-ups in all). Level 1 reads the corners' tile sums, further levels read nodes; the last has one
// node per vertex, in the layout of M-texel textures. A place is x | y << 14 | layer << 28; all ones is none.
uniform sampler2DArray source;
uniform usampler2DArray ring_table;
layout(location = 0) out vec4 total;

vec4 entry(uint place) {
    bool none = place == 0xffffffffu;
    uint at = none ? 0u : place;
    vec4 x = texelFetch(source, ivec3(at & 0x3fffu, at >> 14 & 0x3fffu, at >> 28), 0);
    return none ? vec4(0.0) : x;
}

vec4 add(vec4 a, vec4 x) {
#ifdef MAXIMUM
    return vec4(x.r > a.r ? x.r : a.r, x.g > a.g ? x.g : a.g, x.b > a.b ? x.b : a.b, 0.0);
#else
    return a + x;
#endif
}

void main() {
    vec4 sum = vec4(0.0);
    for (int group = 0; group < 3; ++group) {
        uvec4 places = texelFetch(ring_table, ivec3(ivec2(gl_FragCoord.xy), group), 0);
        sum = add(sum, entry(places.x));
        sum = add(sum, entry(places.y));
        sum = add(sum, entry(places.z));
        sum = add(sum, entry(places.w));
    }
    total = sum;
}
