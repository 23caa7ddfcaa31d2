// Lafortune's model as shaders/model/lafortune.glsl has it, but without one of our mends of its fit (docs/paper.md):
// RAW_N fits n itself, not log n; ONE_START begins at one shape, not at the best of 15.
#define TERM_COUNT 3
#define BASIS_COUNT 2
#define SHAPE_COUNT 3
struct Terms { real x[TERM_COUNT]; };
struct Shape { real x[SHAPE_COUNT]; };
struct Basis { real x[BASIS_COUNT]; };
struct Slope { real x[SHAPE_COUNT]; };

SHARED_FN Terms sample_terms(real3 u, real3 v) {
    Terms t;
    t.x[0] = u.x * v.x + u.y * v.y;
    t.x[1] = u.z * v.z;
    t.x[2] = u.z;
    return t;
}
SHARED_FN real lobe_cosine(Shape s, Terms t) { return s.x[0] * t.x[0] + s.x[1] * t.x[1]; }
SHARED_FN real lobe_log(real D) { return log(max(D, real(1.0e-4))); }
// n, and its derivative by the shape's last number
#ifdef RAW_N
SHARED_FN real exponent(Shape s) { return s.x[2]; }
SHARED_FN real exponent_slope(Shape s) { return real(1.0); }
#else
SHARED_FN real exponent(Shape s) { return exp(s.x[2]); }
SHARED_FN real exponent_slope(Shape s) { return exp(s.x[2]); }
#endif
SHARED_FN real lobe_value(Shape s, real D) {
    return SELECT(D < real(1.0e-4), real(0.0), exp(exponent(s) * lobe_log(D)));
}
SHARED_FN Basis basis(Shape s, Terms t) {
    Basis b;
    b.x[0] = t.x[2];
    b.x[1] = lobe_value(s, lobe_cosine(s, t));
    return b;
}
SHARED_FN Slope shape_slope(Shape s, Terms t) {
    real D = lobe_cosine(s, t);
    real L = lobe_value(s, D);
    real over = L * exponent(s) / max(D, real(1.0e-4));
    Slope g;
    g.x[0] = over * t.x[0];
    g.x[1] = over * t.x[1];
    g.x[2] = L * exponent_slope(s) * lobe_log(D);
    return g;
}
SHARED_FN real2 shape_bend(Shape s, Shape d, Terms t) {
    real D = lobe_cosine(s, t);
    real L = lobe_value(s, D);
    real n = exponent(s);
    real dn = exponent_slope(s) * d.x[2];
    real logarithm = lobe_log(D);
    real ratio = lobe_cosine(d, t) / max(D, real(1.0e-4));
    real q = n * ratio + dn * logarithm;
    real second = q * q + real(2.0) * dn * ratio - n * ratio * ratio;
#ifndef RAW_N
    second = second + dn * d.x[2] * logarithm;
#endif
    return real2(L * q, L * second);
}

#ifdef __cplusplus
static constexpr const char* coefficient_names[BASIS_COUNT] = {"rho_d", "rho_s"};
static constexpr double coefficient_bounds[BASIS_COUNT][2] = {{0, 1}, {0, 4}};
static constexpr int gauge_count = 1;
static real fix_gauge(Shape& s) {
    real largest = max(max(-s.x[0], s.x[1]), real(1.0e-3));
    s.x[0] = s.x[0] / largest;
    s.x[1] = s.x[1] / largest;
    return exp(exponent(s) * log(largest));
}
static Shape gauge_tangent(const Shape& s) { return Shape{{s.x[0], s.x[1], real(0.0)}}; }
#ifdef RAW_N
static constexpr const char* shape_names[SHAPE_COUNT] = {"Cx", "Cz", "n"};
static constexpr double shape_bounds[SHAPE_COUNT][2] = {{-1.5, 0}, {0, 1.5}, {1, 200}};
#define STARTS_OF(Cx, Cz) {Cx, Cz, 4}, {Cx, Cz, 10}, {Cx, Cz, 25}, {Cx, Cz, 60}, {Cx, Cz, 120}
static constexpr int start_count = 15;
static constexpr double starts[start_count][SHAPE_COUNT] = {
    STARTS_OF(-0.85, 1), STARTS_OF(-1, 1), STARTS_OF(-1, 1 / 1.15)};
#undef STARTS_OF
#else
static constexpr const char* shape_names[SHAPE_COUNT] = {"Cx", "Cz", "log_n"};
static constexpr double shape_bounds[SHAPE_COUNT][2] = {{-1.5, 0}, {0, 1.5}, {0, 5.2983173665480363}};
static constexpr int start_count = 1;
static constexpr double starts[start_count][SHAPE_COUNT] = {{-1, 1, 2.302585093}};  // a mirror's direction, n = 10
#endif
#endif
