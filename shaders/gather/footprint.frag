#version 450 core
// variants: WEIGHTED=-,1 NEAREST=-,1
// Where the camera falls in each vertex's view map: the lower-left texel of four, and their weights. In double, for
// there is one per vertex only, and a small weight must keep its relative precision: it may be all that a texel gets.
// WEIGHTED: times the root of what the vertex's samples in this image weigh, so that its look-ups are, too.
#include "model/prelude_double.glsl"
#include "model/lfm.glsl"
#include "model/weight.glsl"
#include "gather/maps.glsl"
uniform sampler2DArray vertex_frames;  // layers: position, tangent, bitangent, normal
uniform vec4 camera_centre[2];  // world: upper and lower part of doubles
layout(location = 0) out vec4 weights;
layout(location = 1) out vec4 base;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    dvec3 centre = dvec3(camera_centre[0].xyz) + dvec3(camera_centre[1].xyz);
    dvec3 to_eye = centre - dvec3(texelFetch(vertex_frames, ivec3(at, 0), 0).xyz);
    to_eye /= sqrt(dot(to_eye, to_eye));
    dvec3 local = dvec3(dot(dvec3(texelFetch(vertex_frames, ivec3(at, 1), 0).xyz), to_eye),
                        dot(dvec3(texelFetch(vertex_frames, ivec3(at, 2), 0).xyz), to_eye),
                        dot(dvec3(texelFetch(vertex_frames, ivec3(at, 3), 0).xyz), to_eye));
#ifdef NEAREST
    dvec4 footprint = lfm_view_nearest(lfm_view_coordinate(local), double(VIEW_SIDE));
#else
    dvec4 footprint = lfm_view_bilinear(lfm_view_coordinate(local), double(VIEW_SIDE));
#endif
    weights = vec4(lfm_view_weights(footprint));
#ifdef WEIGHTED
    weights *= float(sqrt(facing_weight(local.z)));
#endif
    base = vec4(footprint.xy, 0.0, 0.0);
}
