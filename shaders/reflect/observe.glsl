// Samples of a texel for passes that sum over them: EACH_SAMPLE(ADD) does ADD(s) with each. KEPT: of the one image whose
// residual or target residual.frag left in SLS. Else of `image_count` images in turn: a texel's parameters are fetched, and
// its sums blended, once for all of them. Under llvmpipe a pass over a grid took 26 to 29 ns of a core's time per sample
// when it took 4 images, written out; 10 to 11 so, with some hundred (bench_texel_passes).
#ifdef KEPT
#define ONE_IMAGE
#endif
#include "reflect/sample.glsl"
#ifdef KEPT
uniform sampler2D kept;
Sample kept_sample(ivec2 place, Site site) {
    vec4 left = texelFetch(kept, place, 0);
    Sample s = sample_of(view_at(0), site, vec3(0.0));
    s.target = left.rgb;
    s.counts = left.a != 0.0;
    return s;
}
vec3 residual_of(Parameters p, Basis b, Sample s) { return s.counts ? s.target : vec3(0.0); }
#define EACH_SAMPLE(ADD)                 \
    Sample s = kept_sample(place, site); \
    ADD(s);
#else
#include "reflect/pixel.glsl"
uniform int image_count;
#define EACH_SAMPLE(ADD)                                                       \
    PLACE at = in_first_image(place);                                          \
    int end = 3 * (first_view + image_count);                                  \
    for (int view = 3 * first_view; view < end; view += 3, at += next_image) { \
        Pixel pixel = take_pixel(at); /* first: it may be long in coming */    \
        Sample s = observe(view_at(view), site, pixel);                        \
        ADD(s);                                                                \
    }
#endif
