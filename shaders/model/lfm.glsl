// Light field mapping, Eq. 14-15: for vertex v and each colour channel,
//     r = sum_k g_k(s) h_k(v) - L t,       L the barycentric weight of v at the texel's centre.
// Part 1 is evaluated once per (vertex, image), part 2 once per sample and term.

// Part 1: where a view direction falls in a view map of side m.
// `to_camera`: unit direction from the vertex to the camera in the vertex's frame. Result in [0, 1]^2.
SHARED_FN real2 lfm_view_coordinate(real3 to_camera) {
    real2 xy = real2(to_camera.x, to_camera.y);
    real rim = sqrt(xy.x * xy.x + xy.y * xy.y);
    // below the horizon the direction is moved to the rim
    real scale = SELECT(to_camera.z < real(0.0), real(1.0) / max(rim, real(1e-20)), real(1.0));
    return real2(xy.x * scale * real(0.5) + real(0.5), xy.y * scale * real(0.5) + real(0.5));
}

// Lower-left texel of the bilinear footprint (as whole numbers) and the weights of its upper neighbours.
// Texel j's centre is at (j + 1/2) / m; coordinates are clamped to the border texels' centres.
// Result: (j0.x, j0.y, w.x, w.y); j0 <= m - 2, so the footprint always has four distinct texels (m >= 2).
SHARED_FN real4 lfm_view_bilinear(real2 coordinate, real side) {
    real x = min(max(coordinate.x * side - real(0.5), real(0.0)), side - real(1.0));
    real y = min(max(coordinate.y * side - real(0.5), real(0.0)), side - real(1.0));
    real x0 = min(floor(x), side - real(2.0));
    real y0 = min(floor(y), side - real(2.0));
    return real4(x0, y0, x - x0, y - y0);
}

// Nearest look-up in the same form: one weight is 1, the others 0 (the paper's example, Section 5.2.1).
SHARED_FN real4 lfm_view_nearest(real2 coordinate, real side) {
    real4 b = lfm_view_bilinear(coordinate, side);
    return real4(b.x, b.y, SELECT(b.z < real(0.5), real(0.0), real(1.0)), SELECT(b.w < real(0.5), real(0.0), real(1.0)));
}

// Weights of the four texels (x0, y0), (x0+1, y0), (x0, y0+1), (x0+1, y0+1) of a footprint.
SHARED_FN real4 lfm_view_weights(real4 footprint) {
    real u = footprint.z;
    real v = footprint.w;
    real one = real(1.0);
    return real4((one - u) * (one - v), u * (one - v), (one - u) * v, u * v);
}

// Part 2: sums over terms k, all three channels at once.
SHARED_FN real3 lfm_value(real3 g, real3 h) { return g * h; }                         // summed over k: m
SHARED_FN real3 lfm_slope(real3 g, real3 h, real3 dg, real3 dh) { return dg * h + g * dh; }  // a, along d
SHARED_FN real3 lfm_bend(real3 dg, real3 dh) { return dg * dh; }                      // b: r(alpha) = r + alpha a + alpha^2 b
SHARED_FN real3 lfm_gradient_surface(real3 r, real3 h) { return r * h; }              // dE/dg_k
SHARED_FN real3 lfm_gradient_view(real3 r, real3 g) { return r * g; }                 // dE/dh_k[j] / w_j
