// Where a fragment of an N-texel array is: a texel of a corner's surface map, or with VIEW_MAPS of a view map.
#include "distribute/tiles.glsl"
#include "gather/maps.glsl"

#ifdef VIEW_MAPS
ivec2 site_place() { return ivec2(gl_FragCoord.xy); }
ivec2 site_problem() { return site_place() / VIEW_SIDE; }
ivec2 site_cell() { return site_place() % VIEW_SIDE; }
const int site_axis = 1;
const int site_corner = 0;
bool site_holds(ivec2 cell) { return min(cell.x, cell.y) >= 0 && max(cell.x, cell.y) < VIEW_SIDE; }
#else
layout(location = 3) flat in ivec3 frame;
layout(location = 5) flat in ivec2 problem;
uniform int corner;
ivec2 site_place() { return ivec2(gl_FragCoord.xy); }
ivec2 site_problem() { return problem; }
ivec2 site_cell() { return (site_place() - frame.xy) * frame.z; }
#define site_axis frame.z
#define site_corner corner
bool site_holds(ivec2 cell) { return min(cell.x, cell.y) >= 0 && cell.x + cell.y < SIDE; }
#endif
ivec3 site_texel(int k) { return ivec3(site_place(), site_corner * TERMS + k); }

// L of Eq. 9 inside one map: what lies outside is left out, and the centre weight is the number kept.
#define LAPLACIAN(result, FETCH)                                                                     \
    {                                                                                                \
        vec3 centre = FETCH(site_place());                                                           \
        result = vec3(0.0);                                                                          \
        const ivec2 steps[4] = ivec2[4](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));       \
        for (int s = 0; s < 4; ++s) {                                                                \
            bool kept = site_holds(site_cell() + steps[s]);                                          \
            vec3 neighbour = FETCH(site_place() + (kept ? steps[s] * site_axis : ivec2(0)));         \
            result += kept ? centre - neighbour : vec3(0.0);                                         \
        }                                                                                            \
    }
