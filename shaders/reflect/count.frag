#version 450 core
// variants: MODEL=* GRID=-,1 KEPT=-,1 ONE_CAMERA=-,1 COLOUR=8,16
// Sums over samples of each texel, blended: t u_z and u_z^2, which a Lambertian fit needs; how many there are.
#include "reflect/parameters.glsl"
#include "reflect/observe.glsl"
#define RESULTS 2
#include "common/output.glsl"

#define ADD(s) add(s, results)
void add(Sample s, inout vec4 results[RESULTS]) {
    results[0] += s.counts ? s.u.z * vec4(s.target, s.u.z) : vec4(0.0);
    results[1].r += s.counts ? 1.0 : 0.0;
}

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    Site site = site_at(place);
    vec4 results[RESULTS] = vec4[RESULTS](vec4(0.0), vec4(0.0));
    EACH_SAMPLE(ADD)
    WRITE(results);
}
