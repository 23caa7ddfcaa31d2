// Adam; the schedule is optim/adam.h.

// The optimizer goes on from every trial; the best one is accepted.
SHARED_FN void adam_judge(INOUT(ProblemState) s, INOUT(Own) own, Given given, Turn turn) {
    bool running = s.status == STATUS_ACTIVE;
    bool first = s.error >= HUGE_ERROR;
    real norm = given.products[PRODUCT_NORM];
    bool finite_trial = is_finite_error(given.trial_error) && is_finite_error(norm);
    bool accepted = running && finite_trial && given.trial_error < s.error;
    real residual = real(0.5) * given.texels * turn.stop.residual * turn.stop.residual;
    s.iterations = s.iterations + SELECT(running && !first, real(1.0), real(0.0));
    s.accepted = SELECT(accepted, real(1.0), real(0.0));
    s.norm = SELECT(accepted, norm, s.norm);
    s.error = SELECT(accepted, given.trial_error, s.error);
    s.status = SELECT(running && !finite_trial, SELECT(first, STATUS_NOT_FINITE, STATUS_STATIONARY), s.status);
    s.status = SELECT(running && norm == real(0.0), STATUS_STATIONARY, s.status);
    s.status = SELECT(accepted && s.error <= residual, STATUS_RESIDUAL, s.status);
    s.taken = SELECT(s.status == STATUS_ACTIVE, real(1.0), real(0.0));
}

SHARED_FN void adam_keep(INOUT(Elements) e, Registers problem, Constants of_all) {
    element accepted = problem.x[0];
    e.x[0] = where(accepted, e.x[1], e.x[0]);
}

// of_all: decay of both means, the learning rate and the weight of the squares, both without the means' bias towards zero
SHARED_FN void adam_move(INOUT(Elements) e, Registers problem, Constants of_all) {
    const int trial = 0, mean = 1, square = 2, gradient = 3;
    element running = problem.x[0];
    e.x[mean] = of_all.x[0] * e.x[mean] + (real(1.0) - of_all.x[0]) * e.x[gradient];
    e.x[square] = of_all.x[1] * e.x[square] + (real(1.0) - of_all.x[1]) * e.x[gradient] * e.x[gradient];
    element step = of_all.x[2] * e.x[mean] / (sqrt(of_all.x[3] * e.x[square]) + real(1.0e-8));
    e.x[trial] = where(running, e.x[trial] - step, e.x[trial]);
}
