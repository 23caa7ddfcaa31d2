// Residuals of a texel's three corners from its target. The includer defines value_of(corner, k) and `surface`.
vec3 residual_of(int corner, vec3 target, vec3 weights, ivec2 place) {
    vec3 r = -weights[corner] * target;
    for (int k = 0; k < TERMS; ++k)
        r += lfm_value(load(texelFetch(surface, ivec3(place, corner * TERMS + k), 0)), value_of(corner, k));
    return r;
}
