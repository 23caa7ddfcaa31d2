// Samples for passes that sum over them. KEPT: what residual.frag left in SLS, its residual or its target, and BATCH is 1;
// else each fragment takes its pixel itself.
#include "reflect/site.glsl"
#include "reflect/sample.glsl"
#ifdef KEPT
layout(binding = 8) uniform sampler2D kept;
Sample observe(int image, ivec2 place, Site site) {
    Sample s = sample_of(image, site, vec3(0.0));
    vec4 left = texelFetch(kept, place, 0);
    s.target = left.rgb;
    s.counts = left.a != 0.0;
    return s;
}
vec3 residual_of(Parameters p, Basis b, Sample s) { return s.counts ? s.target : vec3(0.0); }
#else
#include "reflect/pixel.glsl"
Sample observe(int image, ivec2 place, Site site) {
    vec3 channels;
    bool present = take_pixel(image, place, site, channels);
    Sample s = sample_of(image, site, channels);
    s.counts = s.counts && present;
    return s;
}
vec3 residual_of(Parameters p, Basis b, Sample s) { return s.counts ? value_of(p, b) - s.target : vec3(0.0); }
#endif
