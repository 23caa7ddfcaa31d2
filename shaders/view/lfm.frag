#version 300 es
// A light field map (shaders/model/lfm.glsl): sum over the triangle's corners and the terms of g_k[texel] h_k(view direction of
// the vertex). Maps: surface maps of term k and corner c at 3 k + c, and view maps, which lfm_vertices.frag has looked up
// for the picture's camera.
// variants: TERMS=1,3 MAPS=26 MEAN_MAP=-,24 VERTEX_ENTRIES=4 STORED_SRGB=-,1 UNCERTAINTY_MAP=-,12
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
#include "model/prelude.glsl"
#include "view/table.glsl"
#include "view/srgb.glsl"
#include "view/maps.glsl"
#include "view/site.glsl"
#include "model/lfm.glsl"
#include "view/safe_view.glsl"
uniform sampler2D vertex_knowledge;  // [vertex]: log2(1 + samples), root mean square residual
uniform float term[TERMS];

vec2 site_knowledge(Site site) {
    vec4 at0 = table_entry(vertex_knowledge, corners.x);
    vec4 at1 = table_entry(vertex_knowledge, corners.y);
    vec4 at2 = table_entry(vertex_knowledge, corners.z);
    float samples = min(at0.x, min(at1.x, at2.x));
    return vec2(samples, site.barycentric.x * at0.y + site.barycentric.y * at1.y + site.barycentric.z * at2.y);
}

vec3 model_value(Site site) {
    vec3 value = vec3(0.0);
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < TERMS; ++k) {
            vec3 h = table_entry(vertex_values, corners[c] * VERTEX_ENTRIES + k).rgb;
            value += term[k] * lfm_value(surface_value(3 * k + c, site), h);
        }
    return safe_view(site, value);
}
#include "view/texel.glsl"
