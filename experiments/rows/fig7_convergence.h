#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::fig7_convergence {
using namespace columns;

struct Problem {
    std::string dataset;
    double lambda;
    uint32_t vertex;
    std::string channel;
    double best_error;
    std::string best_solver;
    double varpro_penalty;
    std::vector<int> arrived;  ///< [solver]
};
inline const RowFileOf<Problem> problems{
    "problems.csv",
    "One row for each problem and weight of the smoothness: iterations that each solver takes to arrive.",
    {{"dataset", key(), "its name", &Problem::dataset},
     {"lambda", key("{:g}"), "weight of the smoothness of both kinds of maps", &Problem::lambda},
     {"vertex channel", key(), "the problem", &Problem::vertex, &Problem::channel},
     {"best_error", errors("{:.8g}").in("E_t"), "of any solver", &Problem::best_error},
     {"best_solver", shown(), "whose it is", &Problem::best_solver},
     {"varpro_penalty", shown("{:.3g}").in("share"), "of variable projection's error, by which the paper's penalty for bounds changes it", &Problem::varpro_penalty},
     {"*", iterations(), "each other column is a solver: to arrive", &Problem::arrived}}};

struct End {
    std::string dataset;
    uint32_t vertex;
    std::string channel;
    double cg_error, sd_error;
    int cg_iterations, sd_iterations;
    bool cg_at_rest, sd_at_rest;
    double cg_minimum, sd_minimum;
    bool cg_minimum_at_rest, sd_minimum_at_rest;
};
inline const RowFileOf<End> ends{
    "ends.csv",
    "One row for each problem of the vertices that run on to their ends.",
    {{"dataset vertex channel", key(), "the problem", &End::dataset, &End::vertex, &End::channel},
     {"cg_error sd_error", errors("{:.8g}").in("E_t"), "at the end", &End::cg_error, &End::sd_error},
     {"cg_iterations sd_iterations", iterations(), "to the end", &End::cg_iterations, &End::sd_iterations},
     {"cg_at_rest sd_at_rest", shown(), "1: E_t fell by less than a millionth in the last 200 iterations", &End::cg_at_rest, &End::sd_at_rest},
     {"cg_minimum sd_minimum", errors("{:.8g}").in("E_t"), "where modern conjugate gradients come to from that end", &End::cg_minimum, &End::sd_minimum},
     {"cg_minimum_at_rest sd_minimum_at_rest", shown(), "1: they came to rest there", &End::cg_minimum_at_rest, &End::sd_minimum_at_rest}}};

struct Point {
    std::string dataset, method;
    size_t shown;
    uint32_t vertex;
    std::string channel;
    int iteration;
    double error, error_over_best;
};
inline const RowFileOf<Point> curves{
    "curves.csv",
    "E_t of the problems that the figure shows, iteration by iteration.",
    {{"dataset", key(), "its name", &Point::dataset},
     {"method", key(), "cg or sd, in the paper's mode", &Point::method},
     {"shown", key(), "which of the shown problems, from 1", &Point::shown},
     {"vertex channel", exact(), "the problem", &Point::vertex, &Point::channel},
     {"iteration", key(), "0 is the start", &Point::iteration},
     {"error", errors("{:.8g}").in("E_t"), "", &Point::error},
     {"error_over_best", errors("{:.8g}"), "over the problem's best error", &Point::error_over_best}}};

struct Summary {
    std::string dataset;
    double lambda;
    size_t problems;
    int cap;
    double ratio_quartile1, ratio_median, ratio_quartile3, cg_median_iterations, sd_median_iterations, varpro_median_iterations, cg_censored_share, sd_censored_share;
};
inline const RowFileOf<Summary> summary{
    "summary.csv",
    "One row for each dataset and weight of the smoothness.",
    {{"dataset", key(), as_before, &Summary::dataset},
     {"lambda", key("{:g}"), as_before, &Summary::lambda},
     {"problems", exact(), "that have samples", &Summary::problems},
     {"cap", exact().in("iterations"), "after which a solver counts as arriving", &Summary::cap},
     {"ratio_quartile1 ratio_median ratio_quartile3", ratios("{:.4g}"), "of steepest descent's over conjugate gradients' iterations to arrive, over problems", &Summary::ratio_quartile1,
      &Summary::ratio_median, &Summary::ratio_quartile3},
     {"cg_median_iterations sd_median_iterations varpro_median_iterations", iterations("{:.4g}"), "to arrive", &Summary::cg_median_iterations, &Summary::sd_median_iterations,
      &Summary::varpro_median_iterations},
     {"cg_censored_share sd_censored_share", shares("{:.4g}"), "of the problems that don't arrive", &Summary::cg_censored_share, &Summary::sd_censored_share}}};

inline const ExperimentEntry experiment{
    .name = "fig7_convergence",
    .about =
        "Figure 7: error by iteration for three problems, conjugate gradients against steepest descent; how many times the iterations steepest descent needs, over all problems; every optimizer that "
        "there is, and Newton's steps; and to which ends both methods come when they run on.",
    .files = {&problems, &ends, &curves, &summary},
    .place = 20,
    .title = "Figure 7: convergence of conjugate gradients and steepest descent",
    .section = "6.1, Figure 7",
    .paper =
        "On three randomly chosen problems conjugate gradients “often” need “an order of magnitude fewer iterations”: “Optim 2” about 25 against about 250. They usually find “a better local "
        "minimum”. The figure's curves are not in our text.",
    .figure =
        "A column of four plots for each of star and bust: the error of three problems by iteration, conjugate gradients solid and steepest descent dashed; the share of all problems by how many "
        "times "
        "the iterations steepest descent needs; the share of problems within 1 % of the best error by iteration, for every solver; and how far apart the two methods' ends lie.",
    .tables = {"summary.csv"}};

}  // namespace radiafit::harness::rows_of::fig7_convergence
