// trial <- p + taken d.
SHARED_FN void advance(INOUT(Elements) e, Registers problem, Constants of_all) {
    const int trial = 0, p = 1, d = 2;
    element taken = problem.x[0];
    e.x[trial] = e.x[p] + taken * e.x[d];
}
