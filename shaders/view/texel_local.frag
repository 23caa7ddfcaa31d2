#version 300 es
// A texel-local model (shaders/model/MODEL.glsl) under a lamp, as eval/safe_relighting.h shows it. Maps: BASIS_COUNT of
// coefficients, (SHAPE_COUNT + 2) / 3 of the shape, then albedo and brightest, both as roots, and what is known.
// variants: MODEL=hsh5 CURVE=1 GRID=1 MAPS=31
// variants: MODEL=* CURVE=0,2 GRID=-,1 NORMAL_MAP=-,7 MAPS=12
// variants: MODEL=lambert CURVE=0 GRID=-,1 NORMAL_MAP=-,7 FIT_NORMALS=8 MAPS=12
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
#include "model/prelude.glsl"
#include "view/table.glsl"
#include "view/curve.glsl"
#include "view/maps.glsl"
#include "view/frame.glsl"
#include "view/site.glsl"
#include "view/enhancement.glsl"
#include "model/MODEL.glsl"
#define SHAPE_MAPS ((SHAPE_COUNT + 2) / 3)
#define ALBEDO_MAP (BASIS_COUNT + SHAPE_MAPS)
uniform vec4 lamp;             // as eye
uniform vec3 intensity;        // linear, of a near lamp at distance 1
uniform float share;           // of the fit; the rest is Lambertian
uniform float most;            // times the brightest that a texel was at a training image: it shows no more
uniform float term[BASIS_COUNT];

vec2 site_knowledge(Site site) { return surface_value(ALBEDO_MAP + 2, site).xy; }

vec3 fitted_value(Site site, vec3 u, vec3 v) {
    Shape s;
#if SHAPE_COUNT > 0
    for (int m = 0; m < SHAPE_MAPS; ++m) {
        vec3 numbers = surface_value(BASIS_COUNT + m, site);
        for (int i = 0; i < 3 && 3 * m + i < SHAPE_COUNT; ++i) s.x[3 * m + i] = numbers[i];
    }
#else
    s.x[0] = 0.0;
#endif
    Basis b = basis(s, sample_terms(u, v));
    vec3 value = vec3(0.0);
    for (int k = 0; k < BASIS_COUNT; ++k) value += term[k] * b.x[k] * surface_value(k, site);
    return light_on_curve(value);
}

vec3 model_value(Site site) {
    vec3 position = site_position(site);
    mat3 frame = frame_of(site_normal(site));
    vec3 to_lamp = direction_to(lamp, position), to_eye = direction_to(eye, position);
    vec3 u = to_local(frame, to_lamp);
    vec3 v = to_local(frame, to_eye);
    if (!(u.z > 0.0 && v.z > 0.0)) return vec3(0.0);
    vec3 irradiance = intensity;
    if (lamp.w > 0.5) irradiance /= dot(lamp.xyz - position, lamp.xyz - position);
    vec3 colour = squared(surface_value(ALBEDO_MAP, site)) * u.z;
    if (site_knowledge(site).x > 0.03) {
        vec3 most_bright = most * squared(surface_value(ALBEDO_MAP + 1, site));
        vec3 fitted = min(max(vec3(0.0), fitted_value(site, u, v)), most_bright);
        colour = min(share * fitted + (1.0 - share) * colour, most_bright);
    }
    return enhanced_value(colour * irradiance, site, to_lamp, to_eye);
}
#include "view/texel.glsl"
