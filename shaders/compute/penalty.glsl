// lambda E_r + mu E_b (Eq. 11) of a vertex's texels. x: a vector's elements; the first term alone has bounds.
#include "model/bounds.glsl"
#include "model/precondition.glsl"
uniform float lambda_surface;
uniform float mu;
uniform vec2 bounds;
uniform int paper_penalty;  // 1: as printed
uniform int view_neighbours;  // where they begin

// A texel of the vertex: its map's first element, its neighbours in the map, and the weight of smoothness there.
struct Site {
    uint first, local;
    uvec2 near;
    vec3 smoothness;
};
uvec2 near_of(uint first, uint local) {
    return uvec2(at_table(TABLE_NEIGHBOURS, first + 2u * local), at_table(TABLE_NEIGHBOURS, first + 2u * local + 1u));
}
uint site_count(Vertex v) { return (v.view_first - v.first) / uint(TERMS) + uint(VIEW_SIDE * VIEW_SIDE); }
Site site_at(Vertex v, uint i) {
    uint surface = (v.view_first - v.first) / uint(TERMS);
    if (i >= surface)
        return Site(v.view_first, i - surface, near_of(uint(view_neighbours), i - surface),
                    OF_THIS_VERTEX(OF_LAMBDA_VIEW).xyz);
    uint word = at_table(TABLE_SITES, v.site + i), map = v.ring + (word >> 16), local = word & 0xffffu;
    return Site(of_map(map, MAP_FIRST), local, near_of(of_map(map, MAP_NEIGHBOUR), local), vec3(lambda_surface));
}
uint element_of(Site site, uint k) { return site.first + site.local * uint(TERMS) + k; }

// L of Eq. 9 inside one map: what lies outside is left out, and the centre's weight is the number kept.
vec3 laplacian(samplerBuffer vector, Site site, uint k) {
    vec3 sum = vec3(0.0), centre = element_at(vector, element_of(site, k));
    for (uint n = 0u; n < 4u; ++n) {
        uint other = ((n < 2u ? site.near.x : site.near.y) >> (16u * (n & 1u))) & 0xffffu;
        if (other != NONE) sum += centre - element_at(vector, site.first + other * uint(TERMS) + k);
    }
    return sum;
}

vec3 bound_error(vec3 x, uint k) {
    return k > 0u ? vec3(0.0) : bound_error(x, vec3(bounds.x), vec3(bounds.y), mu, paper_penalty != 0);
}
vec3 bound_slope(vec3 x, uint k) {
    return k > 0u ? vec3(0.0) : bound_slope(x, vec3(bounds.x), vec3(bounds.y), mu, paper_penalty != 0);
}
vec3 bound_curvature(vec3 x, vec3 d, uint k) {
    return k > 0u ? vec3(0.0) : bound_curvature(x, d, vec3(bounds.x), vec3(bounds.y), mu, paper_penalty != 0);
}
