// The state of one problem (one vertex and colour channel, or one texel), and how two numbers decide its next step.
// Shared by GLSL and C++ (see shaders/model/prelude.glsl for the dialect).

#define MOST_OWN 8
#define STEP_PRODUCTS 4

struct ProblemState {
    real error;        // E_t at the accepted p; HUGE_ERROR before the first evaluation
    real norm;         // z.g at the accepted p, z = g / P (paper: P = 1)
    real slope;        // d.g along the current direction
    real step_factor;  // scales alpha; halved when a steepest step fails
    real beta;         // d <- -z + beta d; zero exactly when d is the steepest direction
    real accepted;     // 1 if the last trial was accepted, else 0
    real status;       // STATUS_*
    real iterations;   // accepted or rejected trials so far, the start not counted
    real alpha;        // the step along d, without its factor
    real taken;        // the trial is p + taken d: alpha times its factor, 0 where the problem has stopped
};

// Numbers private to one optimizer, in addition to the state.
struct Own {
    real x[MOST_OWN];
};

// Sums along d over one problem's samples, penalties included.
struct LineSums {
    real gauss_newton;  // sum r'^2
    real curvature;     // d'Hd = sum r'^2 + r r''
    real third;         // sum a b      (bilinear models, else 0)
    real fourth;        // sum b^2
};

struct StopRules {
    real residual;       // stop at E_t <= residual^2 * texels / 2: root mean square residual, Section 5.3.2 rule 1
    real output_change;  // stop at root mean square change of the model's output, rule 2; both in the dataset's units
};

// What the passes before a step have found out about the problem.
struct Given {
    real texels;       // of the surface
    real trial_error;  // E_t at the trial
    LineSums line;
    real products[STEP_PRODUCTS];  // the first dot products
};

// What is the same for all problems in an iteration.
struct Turn {
    int rule;     // RULE_*
    int restart;  // 1 where the preconditioner was refreshed
    int slot;     // of what the optimizer keeps, such as a pair of lbfgs
    StopRules stop;
    int left_out;     // WITHOUT_*: 0 but in experiments on what a correction of the paper is worth (docs/paper.md)
    real first_step;  // WITHOUT_MEASURED_STEP
};

#define WITHOUT_SIGN 1          // Eq. 7 as printed
#define WITHOUT_GAUSS_NEWTON 2  // d'Hd stays where it isn't positive
#define WITHOUT_DOWNHILL 4      // beta stays where d climbs
#define WITHOUT_RETRY 8         // a problem ends when its error rises
#define WITHOUT_MEASURED_STEP 16  // steepest descent begins with first_step, not with the minimum along its first direction
#define WITHOUT_FIXED_STEP 32  // steepest descent's step grows by a tenth wherever the error falls

#define HUGE_ERROR real(3.0e38)
#define STATUS_ACTIVE real(0.0)
#define STATUS_RESIDUAL real(1.0)
#define STATUS_OUTPUT_CHANGE real(2.0)
#define STATUS_STATIONARY real(3.0)
#define STATUS_MAX_ITERATIONS real(4.0)
#define STATUS_NO_SAMPLES real(5.0)
#define STATUS_NOT_FINITE real(6.0)

#define RULE_STEEPEST_DESCENT 0
#define RULE_CG_PAPER 1
#define RULE_CG_MODERN 2

// Dot products that every optimizer takes; those private to one follow.
#define PRODUCT_NORM 0       // z'.g'
#define PRODUCT_CROSS 1      // z'.g
#define PRODUCT_CONJUGATE 2  // d.g'

// A step factor below this can't change a 32-bit parameter any more: the problem is stationary.
#define SMALLEST_STEP_FACTOR real(9.5e-7)

SHARED_FN real trial_step(ProblemState s) {
    return SELECT(s.status == STATUS_ACTIVE, s.alpha * s.step_factor, real(0.0));
}
SHARED_FN bool is_finite_error(real x) { return abs(x) < HUGE_ERROR; }  // false for NaN
