// Sums of problems' errors in two floats, the second of which holds what rounding takes from the first: as good as a double
// here, which many chips are slow at, or emulate.
// Precise, or a compiler would find that all of it comes to nothing.
vec2 sum_of_two(float a, float b) {
    precise float sum = a + b;
    precise float of_b = sum - a;
    precise float lost = (a - (sum - of_b)) + (b - of_b);
    return vec2(sum, lost);
}
vec2 plus(vec2 sum, vec2 more) {
    vec2 upper = sum_of_two(sum.x, more.x);
    precise float lower = upper.y + (sum.y + more.y);
    return sum_of_two(upper.x, lower);
}
// A problem's error, or 0 where it was never evaluated or is no finite number. By its bits: compilers may presume that there
// are no others.
float finite_error(float error) {
    return (floatBitsToUint(error) & 0x7fffffffu) < floatBitsToUint(HUGE_ERROR) ? error : 0.0;
}
