#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::solvers {
using namespace columns;

// Who has spent its seconds takes no further vertex, so a slow machine compares fewer; and the best error is the least
// of all who came.
struct Problem {
    std::string solver, setting;
    uint32_t vertex;
    std::string channel;
    int iterations_to_101;
    bool reached;
    int iterations;
    double error, best_error;
};
inline const RowFileOf<Problem> problems{
    "problems.csv",
    "One row for each solver and problem.",
    {{"solver setting", key(), "", &Problem::solver, &Problem::setting},
     {"vertex channel", key(), "the problem", &Problem::vertex, &Problem::channel},
     {"iterations_to_101", iterations(), "to arrive, or all that there were", &Problem::iterations_to_101},
     {"reached", exact(), "1: it arrived", &Problem::reached},
     {"iterations", iterations(), "all", &Problem::iterations},
     {"error", errors("{:.8g}").in("E_t"), "at the end", &Problem::error},
     {"best_error", errors("{:.8g}").in("E_t"), "of any solver that took the vertex", &Problem::best_error}},
    partial};

struct Vertex {
    std::string solver, setting;
    uint32_t vertex;
    size_t reached;
    double seconds_to_101;
};
inline const RowFileOf<Vertex> vertices{
    "vertices.csv",
    "One row for each solver and vertex, whose three problems are solved together: what the report's performance profile is of.",
    {{"solver setting vertex", key(), "", &Vertex::solver, &Vertex::setting, &Vertex::vertex},
     {"reached", exact(), "how many of its three problems arrived", &Vertex::reached},
     {"seconds_to_101", shown("{:.6g}").in("s"), "of processor time until all three arrived, or to the end where one didn't: median of the repetitions", &Vertex::seconds_to_101}},
    partial};

struct Repetition {
    std::string solver, setting;
    size_t vertices, repetition;
    double seconds_to_101, seconds_total;
};
inline const RowFileOf<Repetition> repetitions{
    "repetitions.csv",
    "One row for each solver and repetition: sums over the vertices that it took.",
    {{"solver setting", key(), "", &Repetition::solver, &Repetition::setting},
     {"vertices", work(), "that it took before its seconds were spent", &Repetition::vertices},
     {"repetition", repetition(), "from 0", &Repetition::repetition},
     {"seconds_to_101", times("{:.6g}"), "of processor time until each vertex's three problems arrived, or to the end where one didn't", &Repetition::seconds_to_101},
     {"seconds_total", times("{:.6g}"), "of processor time to the end", &Repetition::seconds_total}}};

struct Solver {
    std::string solver, setting;
    int threads;
    size_t vertices, problems;
    double reached_share, seconds_to_101, seconds_to_101_least, seconds_to_101_most, times_cg_modern, times_cg_modern_median, times_varpro, times_varpro_median, iterations_median,
        final_over_best_median, seconds_setup, seconds_total;
    size_t repetitions;
    std::string precision;
    int together;
    std::string instructions;
};
inline const RowFileOf<Solver> solvers{
    "solvers.csv",
    "One row for each solver: the bars of the figure.",
    {{"solver setting", key(), "", &Solver::solver, &Solver::setting},
     {"threads", exact(), "", &Solver::threads},
     {"vertices problems", work(), "that it took", &Solver::vertices, &Solver::problems},
     {"reached_share", shares("{:.6g}"), "of the problems that arrived", &Solver::reached_share},
     {"seconds_to_101 seconds_to_101_least seconds_to_101_most", shown("{:.6g}").in("s"), "median, least and most of repetitions.csv", &Solver::seconds_to_101, &Solver::seconds_to_101_least,
      &Solver::seconds_to_101_most},
     {"times_cg_modern times_cg_modern_median", shown("{:.6g}"), "its seconds over modern conjugate gradients' on the same vertices, of the sums and of the median vertex", &Solver::times_cg_modern,
      &Solver::times_cg_modern_median},
     {"times_varpro times_varpro_median", shown("{:.6g}"), "likewise over variable projection's", &Solver::times_varpro, &Solver::times_varpro_median},
     {"iterations_median", iterations("{:.6g}"), "to arrive", &Solver::iterations_median},
     {"final_over_best_median", errors("{:.6g}"), "the error at the end over the best error", &Solver::final_over_best_median},
     {"seconds_setup", shown("{:.6g}").in("s"), "of preparing the solver", &Solver::seconds_setup},
     {"seconds_total", shown("{:.6g}").in("s"), "to the end, median", &Solver::seconds_total},
     {"repetitions", shown(), "", &Solver::repetitions},
     {"precision", shown(), "of its arithmetic, in bits", &Solver::precision},
     {"together", shown(), "problems that a register holds side by side", &Solver::together},
     {"instructions", shown(), "that its loops are compiled for; Ceres' own loops are those of Debian's library, the costs that it calls ours", &Solver::instructions}}};

inline const ExperimentEntry experiment{
    .name = "solvers",
    .about = "Time until a vertex's error is within 1 % of the best: Ceres in each of its settings, alternating least squares, variable projection, and our optimizers: the paper's, L-BFGS, Adam.",
    .files = {&problems, &vertices, &repetitions, &solvers},
    .place = 130,
    .title = "Solvers side by side",
    .figure = "Dots: the processor time per vertex until its three problems are within 1 % of the least error, one for each solver, on a logarithmic axis.",
    .tables = {"solvers.csv"}};

}  // namespace radiafit::harness::rows_of::solvers
