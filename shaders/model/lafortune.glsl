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

#ifdef __cplusplus
// For C++ alone. Names, and lowest and highest value, of each basis function's coefficient and of the shape.
static constexpr const char* coefficient_names[BASIS_COUNT] = {"rho_d", "rho_s"};
static constexpr const char* shape_names[SHAPE_COUNT] = {"Cx", "Cz", "log_n"};
static constexpr double coefficient_bounds[BASIS_COUNT][2] = {{0, 1}, {0, 4}};
static constexpr double shape_bounds[SHAPE_COUNT][2] = {{-1.5, 0}, {0, 1.5}, {0, 5.2983173665480363}};  // n = 1 to 200

// For materials of other programs: which coefficient is a diffuse albedo, and n, by which the last one's lobe is sharp.
static constexpr int diffuse_coefficient = 0;
static real lobe_exponent(const Shape& s) { return exp(s.x[2]); }

// Gauge: (rho_s, Cx, Cz) -> (rho_s s^-n, s Cx, s Cz) changes nothing, but for the cut. fix_gauge() scales a shape to
// max(|Cx|, |Cz|) = 1, where D <= 1 for any two directions, and returns the factor that rho_s takes in turn.
// gauge_tangent(): the direction in which a shape moves without effect.
static constexpr int gauge_count = 1;  // columns of the Jacobian that depend on the others by it
static real fix_gauge(Shape& s) {
    real largest = max(max(-s.x[0], s.x[1]), real(1.0e-3));
    s.x[0] = s.x[0] / largest;
    s.x[1] = s.x[1] / largest;
    return exp(exp(s.x[2]) * log(largest));
}
static Shape gauge_tangent(const Shape& s) { return Shape{{s.x[0], s.x[1], real(0.0)}}; }

// Where fits begin: n = 4, 10, 25, 60, 120 for each Cx / Cz = -0.85, -1, -1.15, in the gauge above.
#define STARTS_OF(Cx, Cz) \
    {Cx, Cz, 1.386294361}, {Cx, Cz, 2.302585093}, {Cx, Cz, 3.218875825}, {Cx, Cz, 4.094344562}, {Cx, Cz, 4.787491743}
static constexpr int start_count = 15;
static constexpr double starts[start_count][SHAPE_COUNT] = {
    STARTS_OF(-0.85, 1), STARTS_OF(-1, 1), STARTS_OF(-1, 1 / 1.15)};
#undef STARTS_OF
// The last basis function at the five starts that have the Cx and Cz of s: exponents are whole, so by products alone.
// Below the cut D^4 is under 1e-16, which counts as 0.
static void last_basis_at_starts(const Shape& s, const Terms& t, real (&out)[5]) {
    const real D1 = max(lobe_cosine(s, t), real(0.0)), D2 = D1 * D1, D4 = D2 * D2, D8 = D4 * D4;
    const real D10 = D8 * D2, D20 = D10 * D10, D25 = D20 * (D4 * D1), D50 = D25 * D25, D60 = D50 * D10;
    out[0] = D4;
    out[1] = D10;
    out[2] = D25;
    out[3] = D60;
    out[4] = D60 * D60;
}
#endif
