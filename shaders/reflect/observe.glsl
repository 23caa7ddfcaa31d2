// Samples for passes that sum over them. KEPT: what residual.frag left in SLS, its residual or its target, and BATCH is 1;
// else each fragment takes its pixel itself. TAKE_PIXELS takes all of a batch before the first is used: direction.frag over
// a grid took 0.76 to 0.96 of the CPU time so, in four paired runs under llvmpipe.
#include "reflect/site.glsl"
#include "reflect/sample.glsl"
#ifdef KEPT
layout(binding = 8) uniform sampler2D kept;
struct Pixel {
    vec4 left;
};
Pixel take_pixel(int image, ivec2 place, Site site) { return Pixel(texelFetch(kept, place, 0)); }
Sample observe(int image, Site site, Pixel pixel) {
    Sample s = sample_of(image, site, vec3(0.0));
    s.target = pixel.left.rgb;
    s.counts = pixel.left.a != 0.0;
    return s;
}
vec3 residual_of(Parameters p, Basis b, Sample s) { return s.counts ? s.target : vec3(0.0); }
#else
#include "reflect/pixel.glsl"
Sample observe(int image, Site site, Pixel pixel) {
    Sample s = sample_of(image, site, channels_of(pixel));
    s.counts = s.counts && pixel.present;
    return s;
}
vec3 residual_of(Parameters p, Basis b, Sample s) { return s.counts ? value_of(p, b) - s.target : vec3(0.0); }
#endif
#define TAKE(image) pixels[image] = take_pixel(image, place, site)
#define TAKE_PIXELS       \
    Pixel pixels[BATCH]; \
    FOR_EACH_IMAGE(TAKE)
