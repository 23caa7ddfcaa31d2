#version 450 core
// variants: LOSS=* QUANTITY=0,1,2,3 STORAGE=0,1 VALUES=0,1
// One term of a sum along d for one corner (Eq. 13), before the gather. QUANTITY 0: a^2; 1: 2 r b, which with a^2 is d'Hd; 2: a b; 3: b^2.
#define ALONG
#include "model/prelude.glsl"
#define element vec3
#include "model/loss.glsl"
#include "model/lfm.glsl"
#include "gather/maps.glsl"
#include "gather/view_values.glsl"
#ifndef QUANTITY
#define QUANTITY 0
#endif

uniform MAPS surface_maps;
uniform MAPS surface_direction;
uniform sampler2DArray residuals;
uniform int corner;
layout(location = 0) out vec4 product;

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    vec4 sample_at = texelFetch(residuals, ivec3(place, corner), 0);
    vec3 a = vec3(0.0);
    vec3 b = vec3(0.0);
    for (int k = 0; k < TERMS; ++k) {
        vec3 g = load(texelFetch(surface_maps, ivec3(place, corner * TERMS + k), 0));
        vec3 dg = load(texelFetch(surface_direction, ivec3(place, corner * TERMS + k), 0));
        a += lfm_slope(g, view_value(k), dg, view_slope(k));
        b += lfm_bend(dg, view_slope(k));
    }
#if QUANTITY == 0
    vec3 q = a * a;
#elif QUANTITY == 1
    vec3 q = 2.0 * sample_at.rgb * b;
#elif QUANTITY == 2
    vec3 q = a * b;
#else
    vec3 q = b * b;
#endif
    vec3 r = sample_at.rgb;
    product = sample_at.a > 0.0 ? vec4(LOSS_WEIGHTED(r * r, q), 0.0) : vec4(0.0);
}
