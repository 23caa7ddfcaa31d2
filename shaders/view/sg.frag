#version 300 es
// A diffuse colour and spherical Gaussians by view direction (shaders/model/sg.glsl). Maps: the diffuse colour, LOBE_COUNT of
// amplitudes, as many of shapes, what is known.
// variants: LOBE_COUNT=1,4 MAPS=12 MEAN_MAP=10 VERTEX_ENTRIES=1 STORED_SRGB=-,1
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
#include "model/prelude.glsl"
#include "view/table.glsl"
#include "view/srgb.glsl"
#include "view/maps.glsl"
#include "view/frame.glsl"
#include "view/site.glsl"
#include "view/view_frame.glsl"
#include "view/safe_view.glsl"
#include "model/sg.glsl"
uniform float term[BASIS_COUNT];

vec2 site_knowledge(Site site) { return surface_value(1 + 2 * LOBE_COUNT, site).xy; }

vec3 model_value(Site site) {
    vec3 v = to_local(view_frame(site_normal(site)), direction_to(eye, site_position(site)));
    Shape s;
    for (int l = 0; l < LOBE_COUNT; ++l) {
        vec3 numbers = surface_value(1 + LOBE_COUNT + l, site);
        for (int i = 0; i < 3; ++i) s.x[3 * l + i] = numbers[i];
    }
    Terms t;
    t.x[0] = v.x;
    t.x[1] = v.y;
    t.x[2] = v.z;
    Basis b = basis(s, t);
    vec3 value = vec3(0.0);
    for (int k = 0; k < BASIS_COUNT; ++k) value += term[k] * b.x[k] * surface_value(k, site);
    return safe_view(site, value);
}
#include "view/texel.glsl"
