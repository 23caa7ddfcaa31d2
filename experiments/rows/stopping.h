#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::stopping {
using namespace columns;

struct Problem {
    std::string rule;
    double levels;
    std::string optimizer;
    uint32_t vertex;
    std::string channel;
    int stopped_at, arrived_at;
    double error_over_best;
};
inline const RowFileOf<Problem> problems{
    "problems.csv",
    "One row for each rule, threshold, optimizer and problem.",
    {{"rule", key(), "none, residual or output change", &Problem::rule},
     {"levels", key("{:g}").in("1/255"), "the threshold, of a pixel's residual; 0: none", &Problem::levels},
     {"optimizer", key(), "cg or sd", &Problem::optimizer},
     {"vertex channel", key(), "the problem", &Problem::vertex, &Problem::channel},
     {"stopped_at", iterations(), "until the rule stops it", &Problem::stopped_at},
     {"arrived_at", iterations(), "until it arrives", &Problem::arrived_at},
     {"error_over_best", errors("{:.6g}"), "E_t at the end over the best error", &Problem::error_over_best}}};

struct Weight {
    uint32_t vertex;
    double weight;
};
inline const RowFileOf<Weight> weights{
    "weights.csv",
    "What a pixel's residual counts in a vertex's problems.",
    {{"vertex", key(), "", &Weight::vertex}, {"weight", errors("{:.5g}"), "root mean square of its samples' barycentric weights", &Weight::weight}}};

struct Point {
    std::string rule;
    double levels;
    std::string optimizer;
    int iteration;
    double active_share, median_error_over_best;
};
inline const RowFileOf<Point> curves{
    "curves.csv",
    "How problems stop, iteration by iteration.",
    {{"rule", key(), as_before, &Point::rule},
     {"levels", key("{:g}"), as_before, &Point::levels},
     {"optimizer", key(), as_before, &Point::optimizer},
     {"iteration", key(), "0 is the start", &Point::iteration},
     {"active_share", shares("{:.5f}"), "of the problems that have not stopped", &Point::active_share},
     {"median_error_over_best", errors("{:.6g}"), "E_t over the best error", &Point::median_error_over_best}}};

struct Summary {
    std::string rule;
    double levels;
    std::string optimizer;
    int first_below_half, median_reached;
    double median_error_over_best, mean_active_share, short_of_best_share;
    int iterations;
};
inline const RowFileOf<Summary> rules{
    "rules.csv",
    "One row for each rule, threshold and optimizer.",
    {{"rule", key(), as_before, &Summary::rule},
     {"levels", key("{:g}"), as_before, &Summary::levels},
     {"optimizer", key(), as_before, &Summary::optimizer},
     {"first_below_half", iterations(), "until fewer than half of the problems are active", &Summary::first_below_half},
     {"median_reached", iterations(), "until the median problem arrives", &Summary::median_reached},
     {"median_error_over_best", errors("{:.6g}"), "at the end", &Summary::median_error_over_best},
     {"mean_active_share", shares("{:.5f}"), "over iterations", &Summary::mean_active_share},
     {"short_of_best_share", shares("{:.5f}"), "of the problems that did not arrive", &Summary::short_of_best_share},
     {"iterations", exact(), "of the fit, at most", &Summary::iterations}}};

inline const ExperimentEntry experiment{
    .name = "stopping",
    .about =
        "Section 5.3.2: how many problems still run, and how near the median one is to its best error, where thresholds on the residual or on the change of output stop them, with conjugate gradients "
        "and with steepest descent.",
    .files = {&problems, &weights, &curves, &rules},
    .place = 90,
    .title = "Stopping each problem by a threshold",
    .section = "5.3.2",
    .paper = "Stopping by a small difference from the target, or by a small change of the output, is “too restrictive”; and as problems finish early, utilization falls. No values are given.",
    .figure =
        "A row for conjugate gradients' and steepest descent's two rules: the share of problems that still run by iteration, for each threshold; below, the median problem's error above its best.",
    .tables = {"rules.csv"}};

}  // namespace radiafit::harness::rows_of::stopping
