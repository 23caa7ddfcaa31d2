// How alike a surface looks under lamps from the unit directions a and b: the covariance of a Gaussian process over directions
// (squared exponential; Rasmussen and Williams 2006, section 4.2.1) of what all lamps have in common and of what changes over
// `length`, a chord of the unit sphere.
SHARED_FN real light_kernel(real3 a, real3 b, real length) {
    real x = (a.x - b.x) / length;
    real y = (a.y - b.y) / length;
    real z = (a.z - b.z) / length;
    return real(2.0) + exp(real(-0.5) * (x * x + y * y + z * z));
}

// The same of lamps and half vectors: the product with a kernel of what changes with the half vector over `half_length`, a share
// of all (section 4.2.4); 3 of equal directions, as above.
SHARED_FN real light_pair_kernel(real3 a, real3 half_a, real3 b, real3 half_b, real length, real half_length, real half_share) {
    return light_kernel(a, b, length) * (real(1.0) + half_share * (light_kernel(half_a, half_b, half_length) - real(3.0)));
}

// Half way between unit directions, of unit length; shorter where they are opposite, where it is of no direction.
SHARED_FN real3 half_vector(real3 a, real3 b) {
    real3 sum = a + b;
    return sum * (real(1.0) / max(sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z), real(1.0e-6)));
}
