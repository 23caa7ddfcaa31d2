// Hemispherical harmonics (Gautron, Krivanek, Pattanaik, Bouatouch 2004) as a texel-local model: for each colour channel
//     m = sum over k < HSH_ORDER^2 of h_k H_k(u),
// u the unit direction to the light in the texel's frame. The H_k are orthonormal over the hemisphere. They are root two
// times the real spherical harmonics Y_lm, k = l^2 + l + m, l < HSH_ORDER, of the direction (x, y, z) on the whole sphere
// that has u's azimuth and z = 2 u_z - 1. The model knows nothing of the view. HSH_ORDER: 2 to 5.
#define TERM_COUNT 3
#if HSH_ORDER == 2
#define BASIS_COUNT 4
#elif HSH_ORDER == 3
#define BASIS_COUNT 9
#elif HSH_ORDER == 4
#define BASIS_COUNT 16
#else
#define BASIS_COUNT 25
#endif
#define SHAPE_COUNT 0
struct Terms { real x[TERM_COUNT]; };
struct Shape { real x[1]; };  // none
struct Basis { real x[BASIS_COUNT]; };

SHARED_FN Terms sample_terms(real3 u, real3 v) {
    Terms t;
    t.x[0] = u.x;
    t.x[1] = u.y;
    t.x[2] = u.z;
    return t;
}

SHARED_FN Basis basis(Shape s, Terms t) {
    real wider = real(2.0) * sqrt(t.x[2] / (real(1.0) + t.x[2]));
    real x = wider * t.x[0];
    real y = wider * t.x[1];
    real z = real(2.0) * t.x[2] - real(1.0);
    Basis b;
    b.x[0] = real(0.39894228);
    b.x[1] = real(0.690988299) * y;
    b.x[2] = real(0.690988299) * z;
    b.x[3] = real(0.690988299) * x;
#if HSH_ORDER > 2
    real zz = z * z;
    real cosine2 = x * x - y * y;  // times the sine of the angle to z squared: of twice the azimuth
    real sine2 = real(2.0) * x * y;
    b.x[4] = real(0.772548404) * sine2;
    b.x[5] = real(1.54509681) * (y * z);
    b.x[6] = real(0.446031029) * (real(3.0) * zz - real(1.0));
    b.x[7] = real(1.54509681) * (x * z);
    b.x[8] = real(0.772548404) * cosine2;
#endif
#if HSH_ORDER > 3
    real cosine3 = x * cosine2 - y * sine2;
    real sine3 = x * sine2 + y * cosine2;
    real once = real(5.0) * zz - real(1.0);
    b.x[9] = real(0.834447647) * sine3;
    b.x[10] = real(2.04397095) * (z * sine2);
    b.x[11] = real(0.646360368) * (y * once);
    b.x[12] = real(0.527751031) * (z * (once - real(2.0)));
    b.x[13] = real(0.646360368) * (x * once);
    b.x[14] = real(2.04397095) * (z * cosine2);
    b.x[15] = real(0.834447647) * cosine3;
#endif
#if HSH_ORDER > 4
    real twice = real(7.0) * zz - real(1.0);
    real across = z * (twice - real(2.0));
    b.x[16] = real(0.885065385) * (x * sine3 + y * cosine3);
    b.x[17] = real(2.50334294) * (z * sine3);
    b.x[18] = real(0.669046544) * (sine2 * twice);
    b.x[19] = real(0.946174696) * (y * across);
    b.x[20] = real(0.149603355) * ((real(35.0) * zz - real(30.0)) * zz + real(3.0));
    b.x[21] = real(0.946174696) * (x * across);
    b.x[22] = real(0.669046544) * (cosine2 * twice);
    b.x[23] = real(2.50334294) * (z * cosine3);
    b.x[24] = real(0.885065385) * (x * cosine3 - y * sine3);
#endif
    return b;
}

#ifdef __cplusplus
static constexpr const char* coefficient_names[BASIS_COUNT] = {"h0", "h1", "h2", "h3",
#if HSH_ORDER > 2
                                                               "h4", "h5", "h6", "h7", "h8",
#endif
#if HSH_ORDER > 3
                                                               "h9", "h10", "h11", "h12", "h13", "h14", "h15",
#endif
#if HSH_ORDER > 4
                                                               "h16", "h17", "h18", "h19", "h20", "h21", "h22", "h23",
                                                               "h24",
#endif
};
// no bounds
#define HSH_FREE {-1e30, 1e30}
static constexpr double coefficient_bounds[BASIS_COUNT][2] = {HSH_FREE, HSH_FREE, HSH_FREE, HSH_FREE,
#if HSH_ORDER > 2
                                                              HSH_FREE, HSH_FREE, HSH_FREE, HSH_FREE, HSH_FREE,
#endif
#if HSH_ORDER > 3
                                                              HSH_FREE, HSH_FREE, HSH_FREE, HSH_FREE, HSH_FREE,
                                                              HSH_FREE, HSH_FREE,
#endif
#if HSH_ORDER > 4
                                                              HSH_FREE, HSH_FREE, HSH_FREE, HSH_FREE, HSH_FREE,
                                                              HSH_FREE, HSH_FREE, HSH_FREE, HSH_FREE,
#endif
};
#undef HSH_FREE
#endif
