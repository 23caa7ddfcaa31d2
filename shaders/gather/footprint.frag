#version 450 core
// variants: WEIGHTED=-,1 NEAREST=-,1 ONLY=-,0,1
// Where the camera falls in each vertex's view map: the weights of four texels, and the first of them. WEIGHTED: weights times
// the root of what the vertex's samples in this image weigh, so that its look-ups are, too.
#include "gather/maps.glsl"
#include "gather/footprint.glsl"
uniform sampler2DArray vertex_frames;  // layers: position, tangent, bitangent, normal
#define RESULTS 2
#include "common/output.glsl"
vec3 layer(int i) { return texelFetch(vertex_frames, ivec3(gl_FragCoord.xy, i), 0).xyz; }
void main() {
    vec4 weights;
    vec2 texel;
    float root;
    footprint_of(layer(0), layer(1), layer(2), layer(3), weights, texel, root);
#ifdef WEIGHTED
    weights *= root;
#endif
    vec4 results[RESULTS] = vec4[RESULTS](weights, vec4(texel, 0.0, 0.0));
    WRITE(results);
}
