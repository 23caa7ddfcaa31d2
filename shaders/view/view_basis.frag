#version 300 es
// Colours by view direction on a learned basis (src/fits/viewbasis/view_basis.h): y = m . b(v) + sum over k of z_k (u_k . b(v)).
// Maps: RANK of z, the number of the texel's block of the surface, what is known. Table: of every block's 28 polynomials
// the entries of m and u, four at a time.
// variants: RANK=1,10 MAPS=32 MEAN_MAP=12 VERTEX_ENTRIES=1 STORED_SRGB=-,1
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
#define VIEW_DEGREE 6
#define VIEW_TERMS 28
#define ENTRIES ((3 + RANK + 3) / 4)
uniform sampler2D basis_table;
uniform float term[RANK + 1];  // the mean, then the functions

vec2 site_knowledge(Site site) { return surface_value(RANK + 1, site).xy; }

vec3 model_value(Site site) {
    vec3 position = site_position(site);
    vec3 d = to_local(view_frame(site_normal(site)), direction_to(eye, position));
    float x[VIEW_DEGREE + 1];
    float y[VIEW_DEGREE + 1];
    x[0] = 1.0;
    y[0] = 1.0;
    x[1] = d.x;
    y[1] = d.y;
    for (int i = 2; i <= VIEW_DEGREE; ++i) {
        x[i] = 2.0 * d.x * x[i - 1] - x[i - 2];
        y[i] = 2.0 * d.y * y[i - 1] - y[i - 2];
    }
    vec4 along[ENTRIES];  // m . b, then u_k . b
    for (int c = 0; c < ENTRIES; ++c) along[c] = vec4(0.0);
    int entry = int(surface_value(RANK, site).x + 0.5) * VIEW_TERMS * ENTRIES;
    for (int degree = 0; degree <= VIEW_DEGREE; ++degree)
        for (int j = 0; j <= degree; ++j) {
            float b = x[degree - j] * y[j];
            for (int c = 0; c < ENTRIES; ++c) along[c] += b * table_entry(basis_table, entry + c);
            entry += ENTRIES;
        }
    vec3 value = term[0] * along[0].xyz;
    for (int k = 0; k < RANK; ++k) value += term[k + 1] * along[(k + 3) / 4][(k + 3) % 4] * surface_value(k, site);
    return safe_view(site, value);
}
#include "view/texel.glsl"
