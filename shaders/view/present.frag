#version 300 es
// What the screen gets, in sRGB: the fit's picture, which is a sum over several points of each pixel, a stored picture of the
// same view (photograph or baseline), or `error_factor` times their difference in the stored encoding.
precision highp float;
precision highp int;
precision highp sampler2D;
#include "view/srgb.glsl"
uniform sampler2D sum;      // linear light, premultiplied
uniform float pictures;     // summed
uniform vec2 sum_scale;     // pixels of it per pixel here
uniform vec3 exposure;      // from the fit's exposure to the photograph's
uniform sampler2D stored;   // sRGB; alpha: the judge's foreground
uniform vec4 image_to_target;
uniform vec2 stored_size;   // pixels of the photograph
uniform vec4 area;          // of the screen: left, bottom, width, height
uniform int shown;          // 0: fit; 1: stored; 2: difference; 3, 4: stored, or difference, left of the divider, fit right of it
uniform float divider;      // pixels from the left
uniform float error_factor;
out vec4 colour;

void main() {
    vec2 at = gl_FragCoord.xy - area.xy;
    ivec2 most = textureSize(sum, 0) - 1;
    vec4 light = texelFetch(sum, clamp(ivec2(at * sum_scale), ivec2(0), most), 0) / pictures;
    vec3 fit = light.a > 0.0 ? srgb_encoded(clamp(light.rgb * exposure, 0.0, 1.0)) : vec3(0.0);
    colour = vec4(fit, 1.0);
    if (shown == 0) return;
    vec2 pixel = (vec2(at.x, area.w - at.y) - image_to_target.zw) / image_to_target.x;
    vec2 place = pixel / stored_size;
    vec4 picture = texture(stored, place);
    if (any(lessThan(place, vec2(0.0))) || any(greaterThanEqual(place, vec2(1.0)))) picture = vec4(0.0);
    int kind = shown;
    if (shown >= 3) kind = at.x < divider ? shown - 2 : 0;
    vec3 difference = picture.a > 0.5 && light.a > 0.0 ? error_factor * abs(fit - picture.rgb) : vec3(0.0);
    colour = vec4(kind == 0 ? fit : kind == 1 ? picture.rgb : difference, 1.0);
}
