#version 300 es
// A light basis upon a texel-local model (shaders/model/MODEL.glsl): view/light_basis.glsl, whose other maps are those of
// view/safe_texel.glsl. Both fade far from the images that were fitted.
// variants: MODEL=* RANK=9 LAMPS=49 CURVE=0,1,2 GRID=-,1 NORMAL_MAP=-,33 MAPS=34
// variants: MODEL=lambert RANK=9 LAMPS=49 CURVE=2 GRID=-,1 NORMAL_MAP=-,32 FIT_NORMALS=33 MAPS=34
// variants: MODEL=lafortune RANK=9 LAMPS=49 HALF=1 CURVE=2 GRID=-,1 NORMAL_MAP=-,33 MAPS=34
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
#include "view/view_frame.glsl"
#include "model/light_kernel.glsl"
#include "model/MODEL.glsl"
#define Z_MAPS ((RANK + 2) / 3)
#define FIRST_MODEL_MAP Z_MAPS
#define BLOCK_MAP MODEL_MAPS_END
#define ALL_TERMS (RANK + 1 + BASIS_COUNT)
vec3 shown_sum(vec3 sum);
float model_term(int k);
vec3 light_of_basis(Site site, vec3 position, vec3 to_lamp, vec3 value, float darker);
#include "view/safe_texel.glsl"
#include "view/light_basis.glsl"

vec3 shown_sum(vec3 sum) { return sum; }
float model_term(int k) { return term[RANK + 1 + k]; }

/** Per irradiance. */
vec3 light_of_basis(Site site, vec3 position, vec3 to_lamp, vec3 value, float darker) {
    mat3 frame = frame_of(site_normal(site));
    vec3 under = safe_value(site, to_local(frame, to_lamp), to_local(frame, direction_to(eye, position)),
                            site_knowledge(site).x > 0.03);
    return light_on_curve(max(curve_of_light(under * white) + share * darker * value, vec3(0.0))) / white;
}
#include "view/texel.glsl"
