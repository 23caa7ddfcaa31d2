#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 ACCUMULATE=1,3 DIAGONAL=-,1 WIDE=-,1 LOSS=*
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 ACCUMULATE=1,3 ALONG=1 QUARTIC=-,1 LOSS=*
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1 ACCUMULATE=1 TARGET_ONLY=1
// Samples that stay on the device scatter, an invocation each.
#define WITH_CORNERS
#if !defined(ALONG) && !defined(TARGET_ONLY)
#define WITH_ELEMENTS
#define WITH_PAIRS
#endif
#include "compute/accumulate.glsl"
#include "compute/scatter.glsl"
#include "compute/sample_words.glsl"
uniform usamplerBuffer listed_samples;  // the place is a texel of the tile
uniform usamplerBuffer listed_groups;   // [sample]: its group
uniform usamplerBuffer groups;          // [group]: tile; pairs of the three vertices with the image
uniform samplerBuffer target_weights;   // [side][texel]: Lambda of the three corners times the targets' scale
uniform int sample_count;
void main() {
    uint i = group_index() * uint(LANES) + lane();
    if (i >= uint(sample_count)) return;
    WORD word = sample_at(listed_samples, i);
    uvec4 group = texelFetch(groups, int(texelFetch(listed_groups, int(i)).r));
    uint local = place_of(word);
    vec3 weights = texelFetch(target_weights, int(word_of_tile(group.x, TILE_WEIGHT) + local)).xyz;
    scatter(group.x, local, weights, colour_of(word), group.yzw);
}
