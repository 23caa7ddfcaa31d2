#version 450 core
// variants: LANES=32 NUMBER_COUNT=18 NUMBER_STATUS=6 NUMBER_ACCEPTED=5 TERMS=1,3 VIEW_SIDE=8 ALONG=-,1
// Scales by which sums over a vertex's samples stay below 2^61 in fixed point, from bounds of one sample's terms: with G, H
// the largest elements of its surface maps and its view map, every look-up h is at most H, so |r| <= K G H + the largest
// target; and so on. A bit of the 64 is the sign, and three are left for rounding, of bounds and of terms.
#include "compute/vertices.glsl"
#include "compute/scales.glsl"
uniform samplerBuffer maps;  // x
uniform samplerBuffer direction;  // ALONG: d
uniform float most_target;
layout(std430) writeonly buffer Scales { vec4 scale[]; };

// The magnitude of x; infinite for what isn't a number. By its bits: compilers may presume that there is no such thing.
vec3 size_of(vec3 x) { return uintBitsToFloat(min(floatBitsToUint(x) & 0x7fffffffu, uvec3(0x7f800000u))); }
// Largest elements of a vector: of surface maps, and of the view map.
void bounds_of(samplerBuffer vector, Vertex v, out vec3 surface, out vec3 view) {
    surface = view = vec3(0.0);
    uint end = v.view_first + uint(VIEW_SIDE * VIEW_SIDE * TERMS);
    for (uint i = v.first + lane(); i < v.view_first; i += uint(LANES)) surface = max(surface, size_of(element_at(vector, i)));
    for (uint i = v.view_first + lane(); i < end; i += uint(LANES)) view = max(view, size_of(element_at(vector, i)));
    surface = group_max(surface);
    view = group_max(view);
}
// bound: base 2 logarithm of a bound of one sample's term. Where a term might be no finite float, sums have no scale.
void set_scale(int what, vec3 bound) {
    float samples = max(OF_THIS_VERTEX(OF_DENSITY).z, 1.0);
    vec3 power = clamp(floor(60.0 - log2(samples) - bound), -100.0, 100.0);
    scale[vertex_index() * uint(SCALES) + uint(what)] =
        vec4(mix(vec3(0.0), ldexp(vec3(1.0), ivec3(power)), lessThan(bound, vec3(127.0))), 0.0);
}
vec3 logarithm(vec3 x) { return log2(max(x, vec3(1.0e-37))); }

void main() {
    if (!is_active()) return;
    Vertex v = this_vertex();
    vec3 largest_g, largest_h;
    bounds_of(maps, v, largest_g, largest_h);
    vec3 r = logarithm(float(TERMS) * largest_g * largest_h + most_target);
#ifdef ALONG
    vec3 largest_dg, largest_dh;
    bounds_of(direction, v, largest_dg, largest_dh);
    vec3 a = logarithm(float(TERMS) * (largest_dg * largest_h + largest_g * largest_dh));
    vec3 b = logarithm(float(TERMS) * largest_dg * largest_dh);
    if (lane() != 0u) return;
    set_scale(SCALE_LINE, 2.0 * a);
    set_scale(SCALE_LINE + 1, max(2.0 * a, r + b + 1.0) + 1.0);
    set_scale(SCALE_LINE + 2, a + b);
    set_scale(SCALE_LINE + 3, 2.0 * b);
#else
    if (lane() != 0u) return;
    vec3 g = logarithm(largest_g), h = logarithm(largest_h);
    set_scale(SCALE_SURFACE, r + h);
    set_scale(SCALE_VIEW, r + g);
    set_scale(SCALE_ERROR, 2.0 * r);
    set_scale(SCALE_SURFACE_SQUARES, 2.0 * h);
    set_scale(SCALE_VIEW_SQUARES, 2.0 * g);
#endif
}
