#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::batches {
using namespace columns;

struct Fits {
    std::string problem;
    int samples, parameters;
    std::string solver, precision;
    int threads;
    size_t fits, repetitions;
    double arrived_share, fits_per_second, fits_per_second_least, fits_per_second_most, times_rival;
};
inline const RowFileOf<Fits> fits{
    "fits.csv",
    "One row for each problem, solver, precision and number of threads. arrived_share says whether they end at equal errors; TinySolver gets the compiled model's residuals and derivatives, "
    "samples side by side.",
    {{"problem", key(), "gaussian peak, elliptic peak, decay or lafortune", &Fits::problem},
     {"samples", key(), "of each fit", &Fits::samples},
     {"parameters", exact(), "of each fit", &Fits::parameters},
     {"solver precision", key(), "", &Fits::solver, &Fits::precision},
     {"threads", key(), "", &Fits::threads},
     {"fits", work(), "in a repetition: a slow solver takes fewer", &Fits::fits},
     {"repetitions", shown(), "by turns with the other solvers of the problem", &Fits::repetitions},
     {"arrived_share", shares("{:.6g}"), "of the fits whose error is within 1e-5 of the least that any solver found", &Fits::arrived_share},
     {"fits_per_second fits_per_second_least fits_per_second_most", shown("{:.6g}").in("1/s"), "median, least and most of the repetitions", &Fits::fits_per_second, &Fits::fits_per_second_least,
      &Fits::fits_per_second_most},
     {"times_rival", shown("{:.4g}"), "its fits a second over TinySolver's with as many threads, median of the repetitions' ratios", &Fits::times_rival}}};

struct Statistics {
    std::string problem;
    int samples;
    std::string precision, parameter;
    double bias, efficiency, within_68, within_95;
    size_t fits;
};
inline const RowFileOf<Statistics> statistics{
    "statistics.csv",
    "One row for each problem, precision and parameter: of fits whose weights are 1 / variance by a first, unweighted fit's values.",
    {{"problem", key(), "", &Statistics::problem},
     {"samples", key(), "", &Statistics::samples},
     {"precision parameter", key(), "", &Statistics::precision, &Statistics::parameter},
     {"bias", errors("{:.3g}"), "mean error, in bounds of Cramér and Rao", &Statistics::bias},
     {"efficiency", shares("{:.4g}"), "Cramér and Rao's bound of the variance over the variance", &Statistics::efficiency},
     {"within_68 within_95", shares("{:.4g}"), "of the fits within 1 and 1.96 of their own standard deviations of the truth", &Statistics::within_68, &Statistics::within_95},
     {"fits", work(), "that converged", &Statistics::fits}}};

inline const ExperimentEntry experiment{
    .name = "batches",
    .about =
        "Many small fits by `radiafit solve`, beside Ceres' TinySolver by the same residuals and derivatives: peaks in images of 5 x 5 to 20 x 20 pixels with counting noise, exponential decays, "
        "Lafortune's model. How many a second at equal error, and how good the parameters and their error bars are against Cramér and Rao's bound.",
    .files = {&fits, &statistics},
    .place = 147,
    .title = "Many small fits",
    .figure = "Bars: fits a second of each solver, one group for each problem, on a logarithmic axis.",
    .tables = {"fits.csv"}};

}  // namespace radiafit::harness::rows_of::batches
