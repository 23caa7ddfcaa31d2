// A model of no use in which several basis functions depend on the shape: red has a lobe whose sharpness is its own, and
// all have a sheen, whose height is held, that depends on two numbers, one of them red's.
#define TERM_COUNT 3
#define BASIS_COUNT 4
#define SHAPE_COUNT 3
#define SHAPED_COUNT 3
struct Terms { real x[TERM_COUNT]; };
struct Shape { real x[SHAPE_COUNT]; };
struct Basis { real x[BASIS_COUNT]; };

SHARED_FN Terms sample_terms(real3 u, real3 v) {
    real3 h = u + v;
    real length = sqrt(h.x * h.x + h.y * h.y + h.z * h.z);
    Terms t;
    t.x[0] = u.z;
    t.x[1] = log(max(h.z / length, real(1.0e-4)));
    t.x[2] = real(0.5) * length;  // cosine of half the angle between them
    return t;
}
SHARED_FN Basis basis(Shape s, Terms t) {
    Basis b;
    b.x[0] = t.x[0];
    for (int k = 0; k < 2; ++k) b.x[k + 1] = t.x[0] * exp(exp(s.x[k]) * t.x[1]);
    b.x[3] = exp(-s.x[2] * t.x[2]) * (real(1.0) + real(0.2) * s.x[0]);
    return b;
}

#ifdef __cplusplus
static constexpr const char* coefficient_names[BASIS_COUNT] = {"rho_d", "red", "others", "sheen"};
static constexpr const char* shape_names[SHAPE_COUNT] = {"log_n_red", "log_n_others", "falloff"};
static constexpr double coefficient_bounds[BASIS_COUNT][3][2] = {{{0, 1}, {0, 1}, {0, 1}},
                                                                 {{0, 4}, {0, 0}, {0, 0}},
                                                                 {{0, 0}, {0, 4}, {0, 4}},
                                                                 {{0.5, 0.5}, {0.5, 0.5}, {0.25, 0.25}}};
static constexpr double shape_bounds[SHAPE_COUNT][2] = {{0, 4}, {0, 4}, {0.5, 4}};
static constexpr int start_count = 4;
static constexpr double starts[start_count][SHAPE_COUNT] = {{2, 2, 1}, {2, 2, 3}, {3.5, 3.5, 1}, {3.5, 3.5, 3}};
#endif
