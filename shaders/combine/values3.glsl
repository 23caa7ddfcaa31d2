// What combine/map3.vert hands to fragments for its three corners: values of view maps; beyond 8 terms, which would not
// fit into varyings, the places to fetch them from.
#if TERMS > 8
#define VALUES 3
#define VALUES_FETCHED
#else
#define VALUES (3 * TERMS)
#endif
