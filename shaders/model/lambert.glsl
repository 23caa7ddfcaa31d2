// Lambertian reflectance as a texel-local model: m = a_1 u_z, with u the unit direction to the light in the texel's
// frame and a_1 the albedo. What every richer model is measured against.
#define TERM_COUNT 1
#define BASIS_COUNT 1
#define SHAPE_COUNT 0
struct Terms { real x[TERM_COUNT]; };
struct Shape { real x[1]; };  // none
struct Basis { real x[BASIS_COUNT]; };

SHARED_FN Terms sample_terms(real3 u, real3 v) {
    Terms t;
    t.x[0] = u.z;
    return t;
}

SHARED_FN Basis basis(Shape s, Terms t) {
    Basis b;
    b.x[0] = t.x[0];
    return b;
}

#ifdef __cplusplus
static constexpr const char* coefficient_names[BASIS_COUNT] = {"albedo"};
static constexpr double coefficient_bounds[BASIS_COUNT][2] = {{0, 1e30}};
static constexpr int diffuse_coefficient = 0;  // an albedo
#endif
