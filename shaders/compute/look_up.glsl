// What a camera sees of a vertex's view map: h_k, with the root of the samples' weight in it.
uniform usamplerBuffer pairs;  // [pair][2]: weights of texels (x0, y0), (x0 + 1, y0), (x0, y0 + 1), (x0 + 1, y0 + 1), the root in them; the first texel, the root, the vertex
uniform samplerBuffer maps;
layout(std430) writeonly buffer PairValues { vec4 pair_values[]; };
void look_up(uint pair, uint view_first, uvec4 rest) {
    vec4 weights = uintBitsToFloat(texelFetch(pairs, 2 * int(pair)));
    const uint row = uint(VIEW_SIDE * TERMS);
    for (uint k = 0u; k < uint(TERMS); ++k) {
        uint at = view_first + rest.x * uint(TERMS) + k;
        vec3 h = weights.x * element_at(maps, at) + weights.y * element_at(maps, at + uint(TERMS)) +
                 weights.z * element_at(maps, at + row) + weights.w * element_at(maps, at + row + uint(TERMS));
        pair_values[pair * uint(TERMS) + k] = vec4(h, uintBitsToFloat(rest.y));
    }
}
uvec4 rest_of(uint pair) { return texelFetch(pairs, 2 * int(pair) + 1); }
