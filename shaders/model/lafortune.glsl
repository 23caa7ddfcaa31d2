// Lafortune reflectance with one isotropic lobe, Eq. 16-17, as a texel-local model: for each colour channel
//     m = a_1 basis_1 + a_2 basis_2,   basis_1 = u_z,   basis_2 = D^n = L,   D = Cx (u_x v_x + u_y v_y) + Cz u_z v_z,
// with u, v the unit directions to light and camera in the texel's frame, a_1 the diffuse and a_2 the specular albedo.
// The last basis function alone depends on the shape (Cx, Cz, nu = log n), which the channels share. L = 0 where
// D < 1e-4; samples from below the surface (u_z <= 0 or v_z <= 0) don't count, which callers see to.
#define TERM_COUNT 3
#define BASIS_COUNT 2
#define SHAPE_COUNT 3
struct Terms { real x[TERM_COUNT]; };
struct Shape { real x[SHAPE_COUNT]; };
struct Basis { real x[BASIS_COUNT]; };
struct Slope { real x[SHAPE_COUNT]; };

// Part 1, once per sample: what no parameter enters. u_x v_x + u_y v_y, u_z v_z, u_z.
SHARED_FN Terms sample_terms(real3 u, real3 v) {
    Terms t;
    t.x[0] = u.x * v.x + u.y * v.y;
    t.x[1] = u.z * v.z;
    t.x[2] = u.z;
    return t;
}

// Part 2, at every parameter.
SHARED_FN real lobe_cosine(Shape s, Terms t) { return s.x[0] * t.x[0] + s.x[1] * t.x[1]; }
SHARED_FN real lobe_log(real D) { return log(max(D, real(1.0e-4))); }
SHARED_FN real lobe_value(Shape s, real D) {
    return SELECT(D < real(1.0e-4), real(0.0), exp(exp(s.x[2]) * lobe_log(D)));
}

SHARED_FN Basis basis(Shape s, Terms t) {
    Basis b;
    b.x[0] = t.x[2];
    b.x[1] = lobe_value(s, lobe_cosine(s, t));
    return b;
}

// Gradient of the last basis function by the shape: L (n t_0 / D, n t_1 / D, n ln D).
SHARED_FN Slope shape_slope(Shape s, Terms t) {
    real D = lobe_cosine(s, t);
    real scale = lobe_value(s, D) * exp(s.x[2]);
    real over = scale / max(D, real(1.0e-4));
    Slope g;
    g.x[0] = over * t.x[0];
    g.x[1] = over * t.x[1];
    g.x[2] = scale * lobe_log(D);
    return g;
}

// First and second derivative of the last basis function along a change of shape: with q = n dD/D + dn ln D,
// L' = L q and L'' = L (q^2 + 2 dn dD/D - n (dD/D)^2 + dn dnu ln D), dn = n dnu.
SHARED_FN real2 shape_bend(Shape s, Shape d, Terms t) {
    real D = lobe_cosine(s, t);
    real L = lobe_value(s, D);
    real n = exp(s.x[2]);
    real dn = n * d.x[2];
    real logarithm = lobe_log(D);
    real ratio = lobe_cosine(d, t) / max(D, real(1.0e-4));
    real q = n * ratio + dn * logarithm;
    real second = q * q + real(2.0) * dn * ratio - n * ratio * ratio + dn * d.x[2] * logarithm;
    return real2(L * q, L * second);
}
