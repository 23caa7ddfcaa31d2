// Residuals of a texel's three corners from its target in an image. The includer defines value_of(image, corner, k) and weighted(image, corner, target);
// `surface`: g_k of the texel, [corner][term].
vec3 residual_of(int image, int corner, vec3 target, vec3 weights, vec3 surface[3 * TERMS]) {
    vec3 r = -weights[corner] * weighted(image, corner, target);
    for (int k = 0; k < TERMS; ++k) r += lfm_value(surface[corner * TERMS + k], value_of(image, corner, k));
    return r;
}
