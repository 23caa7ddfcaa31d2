// mu E_b (Section 3.1) of a number x with bounds, and its first two derivatives: half the squared distance to them; or as
// `printed`, (x - low)(x - high) beyond them, whose gradient jumps there. A number without bounds has them beyond all others.
// The includer says what an element is, and where(c, a, b): a where c is not zero, else b. C++: model/penalty.h.
SHARED_FN element bound_excess(element x, element low, element high) { return x - min(max(x, low), high); }
SHARED_FN element bound_error(element x, element low, element high, real mu, bool printed) {
    element beyond = bound_excess(x, low, high);
    element error = printed ? (x - low) * (x - high) : real(0.5) * beyond * beyond;
    return where(beyond, mu * error, element(real(0.0)));
}
SHARED_FN element bound_slope(element x, element low, element high, real mu, bool printed) {
    element beyond = bound_excess(x, low, high);
    return where(beyond, mu * (printed ? x + x - low - high : beyond), element(real(0.0)));
}
// The second derivative along a change d of x.
SHARED_FN element bound_curvature(element x, element d, element low, element high, real mu, bool printed) {
    return where(bound_excess(x, low, high), mu * real(printed ? 2.0 : 1.0) * d * d, element(real(0.0)));
}
