// A texel-local model (shaders/model/MODEL.glsl) as eval/safe_relighting.h shows it. Maps from FIRST_MODEL_MAP on: BASIS_COUNT
// of coefficients, (SHAPE_COUNT + 2) / 3 of the shape, then albedo and brightest, both as roots; MODEL_MAPS_END is the next.
// The includer has
//     vec3 shown_sum(vec3 sum)     per irradiance, of the sum of the model's terms
//     float model_term(int k)      what its k-th is multiplied by
#define SHAPE_MAPS ((SHAPE_COUNT + 2) / 3)
#define ALBEDO_MAP (FIRST_MODEL_MAP + BASIS_COUNT + SHAPE_MAPS)
#define MODEL_MAPS_END (ALBEDO_MAP + 2)
uniform float share;  // of the fit; the rest is Lambertian
uniform float most;   // times the brightest that a texel was at a training image: it shows no more

vec3 fitted_value(Site site, vec3 u, vec3 v) {
    Shape s;
#if SHAPE_COUNT > 0
    for (int m = 0; m < SHAPE_MAPS; ++m) {
        vec3 numbers = surface_value(FIRST_MODEL_MAP + BASIS_COUNT + m, site);
        for (int i = 0; i < 3 && 3 * m + i < SHAPE_COUNT; ++i) s.x[3 * m + i] = numbers[i];
    }
#else
    s.x[0] = 0.0;
#endif
    Basis b = basis(s, sample_terms(u, v));
    vec3 sum = vec3(0.0);
    for (int k = 0; k < BASIS_COUNT; ++k) sum += model_term(k) * b.x[k] * surface_value(FIRST_MODEL_MAP + k, site);
    return shown_sum(sum);
}

/** Per irradiance; u and v: to the lamp and the eye, in the texel's frame. */
vec3 safe_value(Site site, vec3 u, vec3 v, bool seen) {
    if (!(u.z > 0.0 && v.z > 0.0)) return vec3(0.0);
    vec3 colour = squared(surface_value(ALBEDO_MAP, site)) * u.z;
    if (!seen) return colour;
    vec3 most_bright = most * squared(surface_value(ALBEDO_MAP + 1, site));
    vec3 fitted = min(max(vec3(0.0), fitted_value(site, u, v)), most_bright);
    return min(share * fitted + (1.0 - share) * colour, most_bright);
}
