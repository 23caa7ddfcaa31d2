// Limited-memory BFGS; the schedule is optim/lbfgs.h. A problem's private numbers are rho of each pair:
// 1 / (s.y), or 0 where there is no pair.
#define LBFGS_ALONG (PRODUCT_CONJUGATE + 1)  // s.y, then d.g

// Where accepted: s <- trial - p, y <- trial gradient - g, and p, g and P move on; elsewhere the pair is empty.
SHARED_FN void lbfgs_keep(INOUT(Elements) e, Registers problem, Constants of_all) {
    const int p = 0, g = 1, precondition = 2, s = 3, y = 4, trial = 5, trial_gradient = 6, fresh = 7;
    element accepted = problem.x[0];
    bool refreshed = of_all.x[0] != real(0.0);
    element moved = e.x[trial] - e.x[p], changed = e.x[trial_gradient] - e.x[g], nothing = accepted - accepted;  // NOLINT: zero, of any type
    e.x[s] = where(accepted, moved, nothing);
    e.x[y] = where(accepted, changed, nothing);
    e.x[p] = where(accepted, e.x[trial], e.x[p]);
    e.x[g] = where(accepted, e.x[trial_gradient], e.x[g]);
    if (refreshed) e.x[precondition] = where(accepted, e.x[fresh], e.x[precondition]);
}

// A pair counts if the curvature along it is positive; a fresh preconditioner forgets all pairs.
SHARED_FN void lbfgs_pair(INOUT(ProblemState) s, INOUT(Own) own, Given given, Turn turn) {
    if (turn.restart != 0)
        for (int i = 0; i < MOST_OWN; ++i) own.x[i] = real(0.0);
    real curvature = given.products[LBFGS_ALONG];
    bool usable = turn.restart == 0 && s.accepted != real(0.0) && curvature > real(1.0e-30) && is_finite_error(curvature);
    own.x[turn.slot] = SELECT(usable, real(1.0) / SELECT(usable, curvature, real(1.0)), real(0.0));
}

SHARED_FN void lbfgs_begin(INOUT(Elements) e, Registers problem, Constants of_all) { e.x[0] = -e.x[1]; }

// d <- d - rho (s.d) y
SHARED_FN void lbfgs_subtract(INOUT(Elements) e, Registers problem, Constants of_all) {
    element rho = problem.x[0], projection = problem.x[1];
    e.x[0] = e.x[0] - rho * projection * e.x[1];
}

// d <- d / P
SHARED_FN void lbfgs_scale(INOUT(Elements) e, Registers problem, Constants of_all) {
    e.x[0] = where(e.x[1], e.x[0] / e.x[1], e.x[0]);
}

// d <- d + rho (s.d before - y.d) s
SHARED_FN void lbfgs_add(INOUT(Elements) e, Registers problem, Constants of_all) {
    element rho = problem.x[0], projection = problem.x[1], back = problem.x[2];
    e.x[0] = e.x[0] + rho * (projection - back) * e.x[1];
}

// Where a trial was accepted and d leads downhill, it is the direction. beta 0 says that d is to be the steepest.
SHARED_FN void lbfgs_slope(INOUT(ProblemState) s, INOUT(Own) own, Given given, Turn turn) {
    real slope = given.products[LBFGS_ALONG];
    bool downhill = s.accepted != real(0.0) && slope < real(0.0) && is_finite_error(slope);
    s.slope = SELECT(downhill, slope, s.slope);
    s.beta = SELECT(downhill, real(1.0), real(0.0));
}

SHARED_FN void lbfgs_choose(INOUT(Elements) e, Registers problem, Constants of_all) {
    const int d = 0, g = 1, precondition = 2;
    element beta = problem.x[0];
    e.x[d] = where(beta, e.x[d], -where(e.x[precondition], e.x[g] / e.x[precondition], e.x[g]));
}
