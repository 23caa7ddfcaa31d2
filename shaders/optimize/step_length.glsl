// After the directional pass: the step length. Eq. 7 as printed climbs: alpha = -d.g / d'Hd.

// E(alpha) - E(0) of a bilinear model, a quartic.
SHARED_FN real line_change(real slope, LineSums q, real alpha) {
    return alpha * (slope + alpha * (real(0.5) * q.curvature + alpha * (q.third + alpha * real(0.5) * q.fourth)));
}

// The positive root of E'(alpha) = slope + curvature alpha + 3 third alpha^2 + 2 fourth alpha^3 with the lowest E;
// 0 if none lowers E. With t = alpha / unit and u = 1/t it is the monic cubic u^3 - A u^2 - B u - C = 0, which stays
// well conditioned as the quartic part vanishes.
SHARED_FN real exact_step(real slope, LineSums q, real unit) {
    real scale = unit / max(-slope, real(1.0e-37));
    real A = q.curvature * scale;
    real B = real(3.0) * q.third * unit * scale;
    real C = real(2.0) * q.fourth * unit * unit * scale;
    // depressed: u = y + A/3, y^3 + P y + Q = 0
    real third = real(1.0) / real(3.0);
    real shift = A * third;
    real P = -B - A * shift;
    real Q = -C - B * shift - real(2.0) * shift * shift * shift;
    real half_q = real(0.5) * Q;
    real third_p = P * third;
    real discriminant = half_q * half_q + third_p * third_p * third_p;
    bool one_root = discriminant > real(0.0);
    // one real root: Cardano, the sum of two cube roots of equal sign
    real w = abs(half_q) + sqrt(max(discriminant, real(0.0)));
    real c = SELECT(w > real(0.0), exp(log(max(w, real(1.0e-37))) * third), real(0.0));
    c = SELECT(half_q > real(0.0), -c, c);
    real single_root = c - SELECT(c == real(0.0), real(0.0), third_p / SELECT(c == real(0.0), real(1.0), c));
    // three real roots: Viete
    real radius = sqrt(max(-third_p, real(0.0)));
    real cube = radius * radius * radius;
    real angle = acos(min(max(-half_q / max(cube, real(1.0e-37)), real(-1.0)), real(1.0))) * third;
    real turn = real(2.0943951023931953);
    real best = real(0.0);
    real best_change = real(0.0);
    for (int k = 0; k < 3; ++k) {
        real y = SELECT(one_root, single_root, real(2.0) * radius * cos(angle - turn * real(k)));
        real u = y + shift;
        for (int polish = 0; polish < 2; ++polish) {  // Newton on the monic cubic
            real value = ((u - A) * u - B) * u - C;
            real derivative = (real(3.0) * u - real(2.0) * A) * u - B;
            real correction = value / SELECT(derivative == real(0.0), real(1.0), derivative);
            u = u - SELECT(abs(correction) < real(0.25) * abs(u), correction, real(0.0));
        }
        real alpha = SELECT(u > real(1.0e-6), unit / SELECT(u > real(1.0e-6), u, real(1.0)), real(0.0));
        real change = line_change(slope, q, alpha);
        bool better = change < best_change;  // false for NaN
        best = SELECT(better, alpha, best);
        best_change = SELECT(better, change, best_change);
    }
    return best;
}

// Writes the step and may stop the problem.
SHARED_FN void step_length(INOUT(ProblemState) s, INOUT(Own) own, Given given, Turn turn) {
    LineSums q = given.line;
    bool running = s.status == STATUS_ACTIVE;
    bool convex = q.curvature > real(0.0) && is_finite_error(q.curvature);
    bool as_it_is = (turn.left_out & WITHOUT_GAUSS_NEWTON) != 0;
    real curvature = as_it_is ? q.curvature : SELECT(convex, q.curvature, q.gauss_newton);  // without this, Eq. 7 climbs where d'Hd <= 0
    bool usable = curvature > real(0.0) && is_finite_error(curvature) && s.slope < real(0.0);
    if ((turn.left_out & (WITHOUT_GAUSS_NEWTON | WITHOUT_DOWNHILL)) != 0)
        usable = curvature != real(0.0) && is_finite_error(curvature) && s.slope != real(0.0);
    real step = SELECT(usable, -s.slope / SELECT(usable, curvature, real(1.0)), real(0.0));
    step = (turn.left_out & WITHOUT_SIGN) != 0 ? -step : step;
    step = (turn.left_out & WITHOUT_MEASURED_STEP) != 0 ? turn.first_step : step;
    real exact = SELECT(turn.rule == RULE_CG_MODERN, exact_step(s.slope, q, step), real(0.0));
    step = SELECT(usable && exact > real(0.0) && is_finite_error(exact), exact, step);
    usable = usable && is_finite_error(step);
    real taken = step * s.step_factor;
    bool small_change = taken * taken * q.gauss_newton <= given.texels * turn.stop.output_change * turn.stop.output_change;
    real status = SELECT(usable, SELECT(small_change && turn.stop.output_change > real(0.0), STATUS_OUTPUT_CHANGE, STATUS_ACTIVE), STATUS_STATIONARY);
    s.status = SELECT(running, status, s.status);
    s.alpha = SELECT(running && usable, step, real(0.0));
    s.taken = trial_step(s);
}
