// After the gradient pass at the trial point: accept or reject, and choose beta (Eq. 8) for d <- -z + beta d (Eq. 6). After a fresh
// preconditioner d <- -z'.
SHARED_FN void judge_trial(INOUT(ProblemState) s, INOUT(Own) own, Given given, Turn turn) {
    int rule = turn.rule;
    bool restart = turn.restart != 0;
    real texels = given.texels;
    StopRules stop = turn.stop;
    real trial_error = given.trial_error;
    real trial_norm = given.products[PRODUCT_NORM];
    real trial_cross = given.products[PRODUCT_CROSS];
    real trial_conjugate = given.products[PRODUCT_CONJUGATE];
    bool running = s.status == STATUS_ACTIVE;
    bool first = s.error >= HUGE_ERROR;
    bool finite_trial = is_finite_error(trial_error) && is_finite_error(trial_norm);
    bool accepted = running && finite_trial && trial_error < s.error;
    bool rejected = running && !accepted;
    bool descent = rule == RULE_STEEPEST_DESCENT;

    // beta: Fletcher-Reeves (Eq. 8), or Polak-Ribiere+ with a Jacobi preconditioner
    real numerator = SELECT(rule == RULE_CG_PAPER, trial_norm, max(trial_norm - trial_cross, real(0.0)));
    bool usable = accepted && !descent && !restart && !first && s.norm > real(0.0);
    real beta = SELECT(usable, numerator / SELECT(usable, s.norm, real(1.0)), real(0.0));
    real slope = -trial_norm + SELECT(usable, beta * trial_conjugate, real(0.0));
    bool downhill = (turn.left_out & WITHOUT_DOWNHILL) != 0 ? true : slope < real(0.0);  // false for NaN
    beta = SELECT(downhill, beta, real(0.0));
    slope = SELECT(downhill, slope, -trial_norm);

    // steepest descent has no directional pass: its change of output |J d|^2 follows from the quadratic model of the step
    real step = s.alpha * s.step_factor;
    real descent_change = real(2.0) * (step * s.norm - (s.error - trial_error));
    bool small_change = descent && !first && descent_change <= texels * stop.output_change * stop.output_change;

    real factor_after_rejection = SELECT(descent || s.beta == real(0.0), real(0.5) * s.step_factor, s.step_factor);
    real factor_of_descent = (turn.left_out & WITHOUT_FIXED_STEP) != 0 ? real(1.1) * s.step_factor : s.step_factor;
    s.step_factor = SELECT(accepted, SELECT(descent, factor_of_descent, real(1.0)), SELECT(rejected, factor_after_rejection, s.step_factor));
    s.slope = SELECT(accepted, slope, SELECT(rejected, -s.norm, s.slope));
    s.norm = SELECT(accepted, trial_norm, s.norm);
    s.beta = SELECT(accepted, beta, SELECT(rejected, real(0.0), s.beta));
    s.iterations = s.iterations + SELECT(running && !first, real(1.0), real(0.0));
    s.accepted = SELECT(accepted, real(1.0), real(0.0));

    real status = s.status;
    status = SELECT(rejected && first, STATUS_NOT_FINITE, status);
    status = SELECT(rejected && !first && s.step_factor < SMALLEST_STEP_FACTOR, STATUS_STATIONARY, status);
    status = (turn.left_out & WITHOUT_RETRY) != 0 ? SELECT(rejected && !first, STATUS_STATIONARY, status) : status;
    status = SELECT(accepted && !(s.norm > real(0.0)), STATUS_STATIONARY, status);
    status = SELECT(accepted && small_change && stop.output_change > real(0.0), STATUS_OUTPUT_CHANGE, status);
    status = SELECT(accepted && trial_error <= real(0.5) * texels * stop.residual * stop.residual, STATUS_RESIDUAL, status);
    s.status = status;
    s.error = SELECT(accepted, trial_error, s.error);
    s.taken = trial_step(s);
}
