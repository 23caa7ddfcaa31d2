// What sweeps leave of samples, where these scatter.
#define WITH_CORNERS
#ifdef OF_ELEMENTS
#define WITH_ELEMENTS
#endif
#include "compute/accumulate.glsl"
#ifdef OF_ELEMENTS
void sums_of(Vertex v, Site site, uint k, bool of_view, out vec3 slope, out vec3 squares) {
    uint at = element_of(site, k);
    slope = SUM(element_sums, at, scale_of(vertex_index(), of_view ? SCALE_VIEW : SCALE_SURFACE));
#ifdef DIAGONAL
    squares = SUM(element_squares, at, scale_of(vertex_index(), of_view ? SCALE_VIEW_SQUARES : SCALE_SURFACE_SQUARES));
#endif
}
#endif
// corner: 3 x tile + corner; what: 0 is E, or one of four along d.
#ifdef OF_ELEMENTS
#define SCALE_OF_CORNER SCALE_ERROR
#else
#define SCALE_OF_CORNER SCALE_LINE
#endif
vec3 sum_of_corner(uint corner, int what) {
    return SUM(corner_sums, corner * uint(TILE_SUMS) + uint(what), scale_of(vertex_index(), SCALE_OF_CORNER + what));
}
