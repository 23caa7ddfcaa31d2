#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::certified {
using namespace columns;

struct Run {
    std::string solver, setting, problem, difficulty;
    int start;
    double digits, error_digits, sigma_digits;
    std::string ended;
    int iterations;
};
inline const RowFileOf<Run> runs{
    "runs.csv",
    "One row for each solver, problem and start.",
    {{"solver setting", key(), "", &Run::solver, &Run::setting},
     {"problem", key(), "NIST's name", &Run::problem},
     {"difficulty", exact(), "by NIST: lower, average or higher", &Run::difficulty},
     {"start", key(), "1, far from the solution, or 2, nearer", &Run::start},
     {"digits", errors("{:.3g}"), "of the parameter that has the fewest right: minus the decimal logarithm of its relative error, 0 to 11, which are all that are certified", &Run::digits},
     {"error_digits", errors("{:.3g}"), "of the sum of squared residuals", &Run::error_digits},
     {"sigma_digits", errors("{:.3g}"), "of the standard deviation that has the fewest right; ours as it says them, of others by QR of the derivatives at their end", &Run::sigma_digits},
     {"ended", exact(), "converged, or what else the solver says of its end", &Run::ended},
     {"iterations", iterations(), "steps tried; of NLopt, Eigen and SciPy evaluations", &Run::iterations}}};

struct Solver {
    std::string solver, setting;
    size_t starts, solved, sigma_right, wrongly_converged;
    double digits_median;
};
inline const RowFileOf<Solver> solvers{
    "solvers.csv",
    "One row for each solver.",
    {{"solver setting", key(), "", &Solver::solver, &Solver::setting},
     {"starts", work(), "of all problems", &Solver::starts},
     {"solved", exact(), "starts from which all parameters come out with 8 digits", &Solver::solved},
     {"sigma_right", exact(), "from which all standard deviations come out with 6", &Solver::sigma_right},
     {"wrongly_converged", exact(), "that it calls converged with less than 4 digits", &Solver::wrongly_converged},
     {"digits_median", errors("{:.3g}"), "over the starts", &Solver::digits_median}}};

inline const ExperimentEntry experiment{
    .name = "certified",
    .about =
        "NIST's 27 nonlinear reference problems from both of their starts: how many certified digits `radiafit solve` finds in doubles, of parameters, standard deviations and residuals, beside "
        "Ceres, its TinySolver, GSL, Eigen, NLopt and, where it is installed, SciPy, all by the same residuals and derivatives.",
    .files = {&runs, &solvers},
    .place = 145,
    .title = "Certified digits",
    .figure = "A square for each solver, problem and start, dark blue where all certified digits are found, red where none is.",
    .tables = {"solvers.csv"}};

}  // namespace radiafit::harness::rows_of::certified
