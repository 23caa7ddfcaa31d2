// A model of no use that has everything in it that models' texts may hold.
#define TERM_COUNT 3
#define BASIS_COUNT 2
#define SHAPE_COUNT 4
struct Terms { real x[TERM_COUNT]; };
struct Shape { real x[SHAPE_COUNT]; };
struct Basis { real x[BASIS_COUNT]; };
struct Pair { real first, second; };
#define QUARTER real(0.25)

SHARED_FN Terms sample_terms(real3 u, real3 v) {
    Terms t;
    t.x[0] = u.x * v.x + u.y * v.y;
    t.x[1] = u.z;
    t.x[2] = v.z;
    return t;
}

SHARED_FN Pair parts(real a, real b) {
    Pair p;
    p.first = a + b;
    p.second = a - b;
    return p;
}
/* Sets what it is given
   to something else. */
SHARED_FN void unused_by_basis(INOUT(real) x) { x = real(0.0); }
// Not shape_slope(...) nor shape_bend(...), but named as what is made.
SHARED_FN real multiply(real a, real b) { return a * b; }
SHARED_FN real squared(real3 a) { return multiply(a.x, a.x) + a.y * a.y + a.z * a.z; }

SHARED_FN Basis basis(Shape s, Terms t) {
    Basis b;
    b.x[0] = t.x[1];
    real sum = QUARTER, turns = real(1);
    int last = SHAPE_COUNT - 1;
    for (int i = 0; i < last; ++i) {
        sum += s.x[i] * t.x[i];
        turns *= real(1.0) + real(0.125) * s.x[i + 1];
    }
    turns -= real(2.5e-1);
    turns /= real(3.0);
    real3 place = real3(s.x[0], s.x[1], real(-0.5)) * real(0.5) + t.x[0] * real3(t.x[2], t.x[1], s.x[2]);
    Pair p = parts(squared(place), turns);
    real clamped = min(max(sum, real(-0.3)), real(0.9)) + sqrt(real(0.3) + p.first * p.first);
    real cut = SELECT(p.second > -sum, exp(-clamped), log(real(2.0) + clamped));
    real other = SELECT(t.x[0] <= s.x[3], -cut / (real(1.5) + s.x[3] * s.x[3]), cut * s.x[3]);
    b.x[1] = real(other) + (cut - turns) / real(4.0) - real(0.5) / (clamped + real(1.0));
    return b;
}

#ifdef __cplusplus
static constexpr const char* coefficient_names[BASIS_COUNT] = {"a", "b"};
static constexpr const char* shape_names[SHAPE_COUNT] = {"p", "q", "r", "s"};
static constexpr double coefficient_bounds[BASIS_COUNT][2] = {{-1e30, 1e30}, {-1e30, 1e30}};
static constexpr double shape_bounds[SHAPE_COUNT][2] = {{-1, 1}, {-1, 1}, {-1, 1}, {-1, 1}};
static constexpr int start_count = 1;
static constexpr double starts[start_count][SHAPE_COUNT] = {{0, 0, 0, 0}};
#endif
