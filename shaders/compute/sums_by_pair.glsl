// What sweeps leave of samples, where each sum has one invocation that makes it: of surface maps in the gradient itself, of
// view maps by cameras' views of the vertex (pairs).
uniform samplerBuffer pair_sums;     // [pair][term]
uniform samplerBuffer pair_squares;
uniform usamplerBuffer pairs;
uniform samplerBuffer tile_sums;     // [tile][corner][TILE_SUMS]
#ifdef OF_ELEMENTS
// Sums over the pairs whose look-ups have a weight on a texel of the view map.
void sum_over_view_texel(Vertex v, uint local, uint k, out vec3 slope, out vec3 squares) {
    slope = squares = vec3(0.0);
    const uvec2 place = uvec2(local % uint(VIEW_SIDE), local / uint(VIEW_SIDE));
    for (uint corner = 0u; corner < 4u; ++corner) {
        uvec2 back = uvec2(corner & 1u, corner >> 1);
        if (any(lessThan(place, back)) || any(greaterThan(place - back, uvec2(VIEW_SIDE - 2)))) continue;
        uint cell = vertex_index() * uint(VIEW_SIDE * VIEW_SIDE + 1) + (place.y - back.y) * uint(VIEW_SIDE) + place.x - back.x;
        uint last = at_table(TABLE_CELL_FIRST, cell + 1u);
        for (uint i = at_table(TABLE_CELL_FIRST, cell); i < last; ++i) {
            uint p = v.pair + at_table(TABLE_CELL_PAIRS, i);
            float weight = uintBitsToFloat(texelFetch(pairs, 2 * int(p))[corner]);
            slope += weight * element_at(pair_sums, p * uint(TERMS) + k);
#ifdef DIAGONAL
            squares += weight * weight * element_at(pair_squares, p * uint(TERMS) + k);
#endif
        }
    }
}
void sums_of(Vertex v, Site site, uint k, bool of_view, out vec3 slope, out vec3 squares) {
    if (of_view) {
        sum_over_view_texel(v, site.local, k, slope, squares);
        return;
    }
    slope = gradient[element_of(site, k)].xyz;
#ifdef DIAGONAL
    squares = fresh[element_of(site, k)].xyz;
#endif
}
#endif
// corner: 3 x tile + corner; what: 0 is E, or one of four along d.
vec3 sum_of_corner(uint corner, int what) { return element_at(tile_sums, corner * uint(TILE_SUMS) + uint(what)); }
