#version 450 core
// variants: MODEL=* GRID=-,1 TARGET_ONLY=-,1 COLOUR=8,16
// The residual of the pixel that each texel takes, or its target, and in alpha whether it counts.
#include "reflect/parameters.glsl"
#define ONE_IMAGE
#include "reflect/pixel.glsl"
uniform MAPS parameters;
layout(location = 0) out vec4 residual;
void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    Site site = site_at(place);
    Sample s = observe(view_at(0), site, take_pixel(in_first_image(place)));
#ifdef TARGET_ONLY
    vec3 value = s.target;
#else
    Parameters p = read_parameters(parameters, place);
    vec3 value = residual_of(p, basis(p.shape, s.terms), s);
#endif
    residual = s.counts ? vec4(value, 1.0) : vec4(0.0);
}
