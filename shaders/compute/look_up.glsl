// What a camera sees of a vertex's view map: h_k, the look-up's weights times the root of the samples' own.
struct Pair {
    vec4 weights;  // of texels (x0, y0), (x0 + 1, y0), (x0, y0 + 1), (x0 + 1, y0 + 1)
    uint texel, image;
    float root;
};
Pair pair_at(uint i) {
    uvec4 rest = texelFetch(pairs, 2 * int(i) + 1);
    return Pair(uintBitsToFloat(texelFetch(pairs, 2 * int(i))), rest.x, rest.y, uintBitsToFloat(rest.z));
}
vec3 element_at(samplerBuffer vector, uint i) { return texelFetch(vector, int(i)).xyz; }
vec3 look_up(samplerBuffer vector, uint view_first, Pair pair, uint k) {
    uint at = view_first + pair.texel * uint(TERMS) + k;
    uint row = uint(VIEW_SIDE * TERMS);
    return pair.weights.x * element_at(vector, at) + pair.weights.y * element_at(vector, at + uint(TERMS)) +
           pair.weights.z * element_at(vector, at + row) + pair.weights.w * element_at(vector, at + row + uint(TERMS));
}
