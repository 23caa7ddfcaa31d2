#version 450 core
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
