// Polynomial texture map (Malzbender, Gelb, Wolters 2001) as a texel-local model: for each colour channel a biquadratic in
// the light's direction, m = a_1 u_x^2 + a_2 u_y^2 + a_3 u_x u_y + a_4 u_x + a_5 u_y + a_6, with u the unit direction to the
// light in the texel's frame. Linear in all six coefficients; it knows nothing of the view.
#define TERM_COUNT 2
#define BASIS_COUNT 6
#define SHAPE_COUNT 0
struct Terms { real x[TERM_COUNT]; };
struct Shape { real x[1]; };  // none
struct Basis { real x[BASIS_COUNT]; };

SHARED_FN Terms sample_terms(real3 u, real3 v) {
    Terms t;
    t.x[0] = u.x;
    t.x[1] = u.y;
    return t;
}

SHARED_FN Basis basis(Shape s, Terms t) {
    Basis b;
    b.x[0] = t.x[0] * t.x[0];
    b.x[1] = t.x[1] * t.x[1];
    b.x[2] = t.x[0] * t.x[1];
    b.x[3] = t.x[0];
    b.x[4] = t.x[1];
    b.x[5] = real(1.0);
    return b;
}

#ifdef __cplusplus
static constexpr const char* coefficient_names[BASIS_COUNT] = {"xx", "yy", "xy", "x", "y", "one"};
static constexpr double coefficient_bounds[BASIS_COUNT][2] = {{-1e30, 1e30}, {-1e30, 1e30}, {-1e30, 1e30},
                                                              {-1e30, 1e30}, {-1e30, 1e30}, {-1e30, 1e30}};
#endif
