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
#define FIRST_MODEL_MAP 0
uniform vec4 lamp;       // as eye
uniform vec3 intensity;  // linear, of a near lamp at distance 1
uniform float term[BASIS_COUNT];

vec3 shown_sum(vec3 sum) { return light_on_curve(sum); }
float model_term(int k) { return term[k]; }
#include "view/safe_texel.glsl"

vec2 site_knowledge(Site site) { return surface_value(MODEL_MAPS_END, site).xy; }

vec3 model_value(Site site) {
    vec3 position = site_position(site);
    mat3 frame = frame_of(site_normal(site));
    vec3 to_lamp = direction_to(lamp, position), to_eye = direction_to(eye, position);
    vec3 irradiance = intensity;
    if (lamp.w > 0.5) irradiance /= dot(lamp.xyz - position, lamp.xyz - position);
    vec3 value = safe_value(site, to_local(frame, to_lamp), to_local(frame, to_eye), site_knowledge(site).x > 0.03);
    return enhanced_value(value * irradiance, site, to_lamp, to_eye);
}
#include "view/texel.glsl"
