// What an image tells a texel (docs/formats.md, "What a light means"; model/texel_options.h says what counts).
#include "combine/batch.glsl"
layout(location = 44) uniform vec4 lamps[BATCH];  // near: where, 1; distant: unit direction to it, 0
// Target per 16-bit unit of a channel, times the squared distance where the lamp is near; the least unit that is clipped,
// below 0 where the batch has no such image.
layout(location = 48) uniform vec4 exposures[BATCH];
layout(location = 52) uniform vec4 eyes[BATCH];   // the camera's centre, 1; or unit direction to it, 0

// Unit direction from x; the squared distance, 1 for what is infinitely far.
vec4 towards(vec4 place, vec3 x) {
    vec3 to = place.xyz - place.w * x;
    float squared = dot(to, to);
    return place.w != 0.0 ? vec4(to * inversesqrt(squared), squared) : vec4(to, 1.0);
}

struct Sample {
    vec3 u;       // to the lamp, in the texel's frame
    vec3 target;
    bool counts;
    Terms terms;
};

// channels: 16-bit units of the pixel that the texel takes.
Sample sample_of(int image, Site site, vec3 channels) {
    Sample s;
    vec4 light = towards(lamps[image], site.position);
    s.u = to_local(site, light.xyz);
    vec3 v = to_local(site, towards(eyes[image], site.position).xyz);
    s.target = channels * (light.w * exposures[image].rgb);
    s.terms = sample_terms(s.u, v);
    s.counts = s.u.z > 0.0 && v.z > 0.0 && all(lessThan(channels, vec3(exposures[image].w))) &&
               s.target.r + s.target.g + s.target.b >= site.darkness * s.u.z;
    return s;
}
