#version 300 es
// A light basis by itself: view/light_basis.glsl.
// variants: RANK=1,9,27 LAMPS=49 CURVE=0,1,2 GRID=-,1 NORMAL_MAP=-,7 MAPS=30
// variants: RANK=9 LAMPS=49 HALF=1 CURVE=2 GRID=-,1 NORMAL_MAP=-,7 MAPS=30
// variants: RANK=9 LAMPS=49 CURVE=0 GRID=-,1 NORMAL_MAP=-,7 FIT_NORMALS=8 MAPS=30
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
#define Z_MAPS ((RANK + 2) / 3)
#define BLOCK_MAP Z_MAPS
#define ALL_TERMS (RANK + 1)
vec3 light_of_basis(Site site, vec3 position, vec3 to_lamp, vec3 value, float darker);
#include "view/light_basis.glsl"

/** Per irradiance. */
vec3 light_of_basis(Site site, vec3 position, vec3 to_lamp, vec3 value, float darker) {
    return darker * light_on_curve(max(value, vec3(0.0))) / white;
}
#include "view/texel.glsl"
