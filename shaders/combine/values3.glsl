// What combine/map3.vert hands to fragments for its three corners and every image: values of view maps,
// [image][corner][term]; beyond 8 terms, which would not fit into varyings, the places to fetch them from.
#include "combine/batch.glsl"
#ifdef WEIGHTED
#define VIEW_VALUE vec4  // with the root of the samples' weight (gather/look_up.frag)
#else
#define VIEW_VALUE vec3
#endif
#if TERMS > 8
#define VALUES 3
#define VALUES_FETCHED
#else
#define VALUES (BATCH * 3 * TERMS)
#endif
