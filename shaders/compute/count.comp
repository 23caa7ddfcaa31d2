#version 450 core
// variants: LANES=32 NUMBER_COUNT=10 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1 VIEW_SIDE=8 WIDE=-,1
// The sum of a vertex's targets L t, and how many samples it has.
#include "compute/vertices.glsl"
#include "compute/samples.glsl"
void main() {
    if (vertex_index() >= uint(vertex_count)) return;
    Vertex v = this_vertex();
    vec4 sum = vec4(0.0);
    uint texels = (v.view_first - v.first) / uint(TERMS);
    for (uint i = lane(); i < texels; i += uint(LANES)) {
        uint word = at_table(TABLE_SITES, v.site + i), map = v.ring + (word >> 16), local = word & 0xffffu;
        uint texel = of_map(map, MAP_TEXEL) + local;
        uint first = at_table(TABLE_TEXEL_FIRST, texel), last = at_table(TABLE_TEXEL_FIRST, texel + 1u);
        vec3 colours = vec3(0.0);
        for (uint s = first; s < last; ++s) colours += colour_of(sample_at(samples_by_texel, s));
        sum += vec4(target_weight(map, local) * colours, float(last - first));
    }
    sum = group_sum(sum);
    if (lane() == 0u) OF_THIS_VERTEX(OF_TARGETS) = sum;
}
