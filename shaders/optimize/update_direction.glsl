// Where accepted: p <- trial, g <- trial gradient, P <- fresh P. Then d <- -z + beta d (Eq. 6), z = g / P or g.
SHARED_FN void update_direction(INOUT(Elements) e, Registers problem, Constants of_all) {
    const int p = 0, g = 1, precondition = 2, d = 3, trial = 4, trial_gradient = 5, fresh = 6;
    element accepted = problem.x[0], beta = problem.x[1];
    bool preconditioned = of_all.x[0] != real(0.0), refreshed = of_all.x[1] != real(0.0);
    e.x[p] = where(accepted, e.x[trial], e.x[p]);
    e.x[g] = where(accepted, e.x[trial_gradient], e.x[g]);
    if (refreshed) e.x[precondition] = where(accepted, e.x[fresh], e.x[precondition]);
    element z = e.x[g];
    if (preconditioned) z = where(e.x[precondition], e.x[g] / e.x[precondition], e.x[g]);
    e.x[d] = beta * e.x[d] - z;
}
