#version 450 core
// variants: STORAGE=1 OWN_HALVES=-,1
// variants: STORAGE=0,2
// variants: STORAGE=0,1,2 FROM_STORAGE=1
// An array of floats into the storage of N-texel arrays, or with FROM_STORAGE back: what tests measure rounding by.
#include "gather/maps.glsl"
#ifdef FROM_STORAGE
uniform MAPS maps;
layout(location = 0) out vec4 values;
void main() { values = vec4(load(texelFetch(maps, ivec3(ivec2(gl_FragCoord.xy), 0), 0)), 0.0); }
#else
uniform sampler2DArray values;
layout(location = 0) out STORED stored;
void main() { stored = store(texelFetch(values, ivec3(ivec2(gl_FragCoord.xy), 0), 0).rgb); }
#endif
