// How alike a surface looks under lamps from the unit directions a and b: the covariance of a Gaussian process over directions
// (squared exponential; Rasmussen and Williams 2006, section 4.2.1) of what all lamps have in common and of what changes over
// `length`, a chord of the unit sphere.
SHARED_FN real light_kernel(real3 a, real3 b, real length) {
    real x = (a.x - b.x) / length;
    real y = (a.y - b.y) / length;
    real z = (a.z - b.z) / length;
    return real(2.0) + exp(real(-0.5) * (x * x + y * y + z * z));
}
