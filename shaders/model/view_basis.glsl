// Colours of a texel by view direction v, a unit vector in the texel's frame (x across the mean camera's up and the
// normal, z the normal), under light that stays: for each channel c
//     m_c . b(v) + sum over k of z_kc (u_k . b(v)),
// where b are products of Chebyshev polynomials, T_i(x) T_j(y), i + j <= VIEW_DEGREE: by degree, and of one degree by j.
#define VIEW_DEGREE 6
#define VIEW_TERMS 28
struct ViewTerms { real x[VIEW_TERMS]; };

SHARED_FN ViewTerms view_terms(real3 v) {
    real x[VIEW_DEGREE + 1];
    real y[VIEW_DEGREE + 1];
    x[0] = real(1.0);
    y[0] = real(1.0);
    x[1] = v.x;
    y[1] = v.y;
    for (int i = 2; i <= VIEW_DEGREE; ++i) {
        x[i] = real(2.0) * v.x * x[i - 1] - x[i - 2];
        y[i] = real(2.0) * v.y * y[i - 1] - y[i - 2];
    }
    ViewTerms b;
    int at = 0;
    for (int degree = 0; degree <= VIEW_DEGREE; ++degree)
        for (int j = 0; j <= degree; ++j) {
            b.x[at] = x[degree - j] * y[j];
            at = at + 1;
        }
    return b;
}

// What a sample seen in this direction counts: the cosine with the normal, at least a little.
SHARED_FN real view_weight(real3 v) { return max(v.z, real(0.05)); }
