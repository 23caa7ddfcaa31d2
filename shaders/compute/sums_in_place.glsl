// What sweeps leave of samples, where each sum has one invocation that makes it image by image: all in the gradient itself.
uniform samplerBuffer tile_sums;  // [tile][corner][TILE_SUMS]
#ifdef OF_ELEMENTS
void sums_of(Vertex v, Site site, uint k, bool of_view, out vec3 slope, out vec3 squares) {
    slope = gradient[element_of(site, k)].xyz;
#ifdef DIAGONAL
    squares = fresh[element_of(site, k)].xyz;
#endif
}
#endif
// corner: 3 x tile + corner; what: 0 is E, or one of four along d.
vec3 sum_of_corner(uint corner, int what) { return element_at(tile_sums, corner * uint(TILE_SUMS) + uint(what)); }
