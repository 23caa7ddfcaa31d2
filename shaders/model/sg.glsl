// Colours of a texel by view direction v, a unit vector in the texel's frame, under light that stays: for each channel
//     m = d + sum over l of a_l G_l(v),   G(v) = exp(lambda (v . xi - 1)),
// a diffuse colour and LOBE_COUNT spherical Gaussians. A lobe's shape, which the channels share, is (x, y, log lambda),
// its axis xi = (2x, 2y, 1 - x^2 - y^2) / (1 + x^2 + y^2): the stereographic projection, with the normal at x = y = 0
// and the horizon on the unit circle.
#define TERM_COUNT 3
#define BASIS_COUNT (1 + LOBE_COUNT)
#define SHAPE_COUNT (3 * LOBE_COUNT)
struct Terms { real x[TERM_COUNT]; };
struct Shape { real x[SHAPE_COUNT]; };
struct Basis { real x[BASIS_COUNT]; };
struct Slope { real x[SHAPE_COUNT]; };

// v . xi - 1 of the lobe whose shape begins at number i.
SHARED_FN real off_axis(Shape s, int i, Terms t) {
    real x = s.x[i];
    real y = s.x[i + 1];
    real squared = x * x + y * y;
    return (real(2.0) * (x * t.x[0] + y * t.x[1]) + (real(1.0) - squared) * t.x[2]) / (real(1.0) + squared) -
           real(1.0);
}

SHARED_FN Basis basis(Shape s, Terms t) {
    Basis b;
    b.x[0] = real(1.0);
    for (int l = 0; l < LOBE_COUNT; ++l) b.x[l + 1] = exp(exp(s.x[3 * l + 2]) * off_axis(s, 3 * l, t));
    return b;
}

// Gradient of each lobe by its own shape: d(v . xi)/dx = (2 v_x - 2 x (v_z + v . xi)) / (1 + x^2 + y^2).
SHARED_FN Slope shape_slope(Shape s, Terms t) {
    Slope g;
    for (int l = 0; l < LOBE_COUNT; ++l) {
        real x = s.x[3 * l];
        real y = s.x[3 * l + 1];
        real lambda = exp(s.x[3 * l + 2]);
        real off = off_axis(s, 3 * l, t);
        real scaled = lambda * exp(lambda * off);
        real turn = t.x[2] + off + real(1.0);
        real over = real(2.0) * scaled / (real(1.0) + x * x + y * y);
        g.x[3 * l] = over * (t.x[0] - x * turn);
        g.x[3 * l + 1] = over * (t.x[1] - y * turn);
        g.x[3 * l + 2] = scaled * off;
    }
    return g;
}
