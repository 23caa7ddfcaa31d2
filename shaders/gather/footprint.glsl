// Where the camera falls in a vertex's view map: the lower-left texel of four, and their weights. In double, for there is
// one per vertex only, and a small weight must keep its relative precision: it may be all that a texel gets. Look-ups are
// bilinear, or NEAREST.
#include "model/prelude_double.glsl"
#include "model/lfm.glsl"
#include "model/weight.glsl"
uniform vec4 camera_centre[2];  // world: upper and lower part of doubles

// base: texel; root: of what the vertex's samples in this image weigh, 1 unless WEIGHTED.
void footprint_of(vec3 position, vec3 tangent, vec3 bitangent, vec3 normal, out vec4 weights, out vec2 base, out float root) {
    dvec3 centre = dvec3(camera_centre[0].xyz) + dvec3(camera_centre[1].xyz);
    dvec3 to_eye = centre - dvec3(position);
    to_eye /= sqrt(dot(to_eye, to_eye));
    dvec3 local = dvec3(dot(dvec3(tangent), to_eye), dot(dvec3(bitangent), to_eye), dot(dvec3(normal), to_eye));
#ifdef NEAREST
    dvec4 footprint = lfm_view_nearest(lfm_view_coordinate(local), double(VIEW_SIDE));
#else
    dvec4 footprint = lfm_view_bilinear(lfm_view_coordinate(local), double(VIEW_SIDE));
#endif
    weights = vec4(lfm_view_weights(footprint));
    base = vec2(footprint.xy);
#ifdef WEIGHTED
    root = float(sqrt(facing_weight(local.z)));
#else
    root = 1.0;
#endif
}
