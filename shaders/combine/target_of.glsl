// The target that a pixel's colour stands for. COLOUR: its bits per channel.
#ifndef COLOUR
#define COLOUR 8
#endif
layout(location = 11) uniform float target_scale;  // per unit of a 16-bit channel
vec3 target_of(uvec3 channels) { return target_scale * vec3(COLOUR == 8 ? channels * 257u : channels); }
