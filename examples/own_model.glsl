// A Blinn-Phong lobe over a diffuse part: m = rho_d u_z + rho_s u_z (h_z)^n, h halfway between the unit directions u to the
// lamp and v to the camera. Its shape is nu = log n.
#define TERM_COUNT 2
#define BASIS_COUNT 2
#define SHAPE_COUNT 1
struct Terms { real x[TERM_COUNT]; };
struct Shape { real x[SHAPE_COUNT]; };
struct Basis { real x[BASIS_COUNT]; };

SHARED_FN Terms sample_terms(real3 u, real3 v) {
    real3 h = u + v;
    Terms t;
    t.x[0] = u.z;
    t.x[1] = log(max(h.z / sqrt(h.x * h.x + h.y * h.y + h.z * h.z), real(1.0e-4)));  // log h_z <= 0
    return t;
}
SHARED_FN Basis basis(Shape s, Terms t) {
    Basis b;
    b.x[0] = t.x[0];
    b.x[1] = t.x[0] * exp(exp(s.x[0]) * t.x[1]);
    return b;
}

#ifdef __cplusplus
static constexpr const char* coefficient_names[BASIS_COUNT] = {"rho_d", "rho_s"};
static constexpr const char* shape_names[SHAPE_COUNT] = {"log_n"};
static constexpr double coefficient_bounds[BASIS_COUNT][2] = {{0, 1}, {0, 4}};
static constexpr double shape_bounds[SHAPE_COUNT][2] = {{0, 7}};
static constexpr int start_count = 3;
static constexpr double starts[start_count][SHAPE_COUNT] = {{2}, {3.5}, {5}};
#endif
