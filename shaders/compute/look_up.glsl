// What a camera sees of a vertex's view map: h_k, the look-up's weights times the root of the samples' own.
struct Pair {
    vec4 weights;  // of texels (x0, y0), (x0 + 1, y0), (x0, y0 + 1), (x0 + 1, y0 + 1)
    uint texel, image;
    float root;
};
Pair pair_at(uint i) {
    uvec4 rest = pairs[2u * i + 1u];
    return Pair(uintBitsToFloat(pairs[2u * i]), rest.x, rest.y, uintBitsToFloat(rest.z));
}
#define LOOK_UP(vector, view_first, pair, k)                                                                    \
    (pair.weights.x * vector[view_first + pair.texel * uint(TERMS) + k].xyz +                                   \
     pair.weights.y * vector[view_first + (pair.texel + 1u) * uint(TERMS) + k].xyz +                            \
     pair.weights.z * vector[view_first + (pair.texel + uint(VIEW_SIDE)) * uint(TERMS) + k].xyz +               \
     pair.weights.w * vector[view_first + (pair.texel + uint(VIEW_SIDE) + 1u) * uint(TERMS) + k].xyz)
