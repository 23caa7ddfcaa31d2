// Lafortune's model as shaders/model/lafortune.glsl has it, but fitted is n itself in place of log n (docs/paper.md, M8).
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
SHARED_FN real lobe_value(Shape s, real D) {
    return SELECT(D < real(1.0e-4), real(0.0), exp(s.x[2] * lobe_log(D)));
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
    real over = L * s.x[2] / max(D, real(1.0e-4));
    Slope g;
    g.x[0] = over * t.x[0];
    g.x[1] = over * t.x[1];
    g.x[2] = L * lobe_log(D);
    return g;
}
SHARED_FN real2 shape_bend(Shape s, Shape d, Terms t) {
    real D = lobe_cosine(s, t);
    real L = lobe_value(s, D);
    real n = s.x[2];
    real dn = d.x[2];
    real logarithm = lobe_log(D);
    real ratio = lobe_cosine(d, t) / max(D, real(1.0e-4));
    real q = n * ratio + dn * logarithm;
    real second = q * q + real(2.0) * dn * ratio - n * ratio * ratio;
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
    return exp(s.x[2] * log(largest));
}
static Shape gauge_tangent(const Shape& s) { return Shape{{s.x[0], s.x[1], real(0.0)}}; }
static constexpr const char* shape_names[SHAPE_COUNT] = {"Cx", "Cz", "n"};
static constexpr double shape_bounds[SHAPE_COUNT][2] = {{-1.5, 0}, {0, 1.5}, {1, 200}};
#define STARTS_OF(Cx, Cz) {Cx, Cz, 4}, {Cx, Cz, 10}, {Cx, Cz, 25}, {Cx, Cz, 60}, {Cx, Cz, 120}
static constexpr int start_count = 15;
static constexpr double starts[start_count][SHAPE_COUNT] = {
    STARTS_OF(-0.85, 1), STARTS_OF(-1, 1), STARTS_OF(-1, 1 / 1.15)};
#undef STARTS_OF
#endif
