#version 450 core
// Per tile and corner, over its texels: sum of r g_k of one term, and with WITH_ERROR sum of r^2, blended over images.
// DIAGONAL: sum of g_k^2 where a sample is.
#include "model/prelude.glsl"
#include "model/lfm.glsl"
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"
#include "combine/tile_at_one.glsl"
layout(binding = 2) uniform MAPS surface;
layout(binding = 4) uniform sampler2DArray residuals;
layout(location = 10) uniform int term;
layout(location = 0) out vec4 product[3];
#ifdef WITH_ERROR
layout(location = 3) out vec4 error[3];
#endif
void main() {
    ivec3 frame = tile_frame(whole_tile(), SIDE);
    vec3 products[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 errors[3] = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
    int rows = rows_to_visit();
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < SIDE - j; ++i) {
            ivec2 place = frame.xy + frame.z * ivec2(i, j);
            for (int corner = 0; corner < 3; ++corner) {
                vec4 sample_at = texelFetch(residuals, ivec3(place, corner), 0);
                vec3 g = load(texelFetch(surface, ivec3(place, corner * TERMS + term), 0));
#ifdef DIAGONAL
                products[corner] += sample_at.a * g * g;
#else
                products[corner] += lfm_gradient_view(sample_at.rgb, g);
#endif
                errors[corner] += sample_at.rgb * sample_at.rgb;
            }
        }
    for (int corner = 0; corner < 3; ++corner) {
        product[corner] = vec4(products[corner], 0.0);
#ifdef WITH_ERROR
        error[corner] = vec4(errors[corner], 0.0);
#endif
    }
}
