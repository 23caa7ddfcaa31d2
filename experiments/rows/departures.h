#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::departures {
using namespace columns;

struct Fit {
    std::string departure, without, problem, optimizer, numbers, renderer;
    int iterations;
    size_t problems;
    std::optional<double> arrived_share, iterations_median, stalled_share, not_finite_share, error, error_ratio, psnr_db, ape, held_psnr_db;
};
inline const RowFileOf<Fit> fits{
    "fits.csv",
    "One row for each fit, with all mends of the paper's text or without one of them; docs/paper.md says what each is.",
    {{"departure", key(), "its name in docs/paper.md; empty: nothing is left out", &Fit::departure},
     {"without", key(), "what is left out, in words", &Fit::without},
     {"problem", key(), "light field map or Lafortune", &Fit::problem},
     {"optimizer", key(), "cg or sd", &Fit::optimizer},
     {"numbers", key(), "what parameters are stored in, and sums taken in", &Fit::numbers},
     {"renderer", shown(), "", &Fit::renderer},
     {"iterations", exact(), "of the fit", &Fit::iterations},
     {"problems", exact(), "that have samples", &Fit::problems},
     {"arrived_share", shares("{:.4f}"), "of the problems", &Fit::arrived_share},
     {"iterations_median", iterations("{:g}"), "to arrive; who doesn't counts as one more than the fit has", &Fit::iterations_median},
     {"stalled_share", shares("{:.4f}"), "of the problems that have stopped without arriving", &Fit::stalled_share},
     {"not_finite_share", shares("{:.4f}"), "of the problems that ended at no number", &Fit::not_finite_share},
     {"error", errors("{:.6g}").in("E"), "the sum over problems, penalties left out", &Fit::error},
     {"error_ratio", errors("{:.5g}"), "over that of the fit with all mends", &Fit::error_ratio},
     {"psnr_db", decibels("{:.3f}"), "of training images", &Fit::psnr_db},
     {"ape", errors("{:.3f}").in("1/255"), "of training images", &Fit::ape},
     {"held_psnr_db", decibels("{:.3f}"), "of held-out images", &Fit::held_psnr_db}}};

struct Culling {
    std::string departure, without, renderer;
    size_t images;
    double fragments, operations, reads, operations_ratio, reads_ratio;
    bool same_parameters;
};
inline const RowFileOf<Culling> culling{
    "culling.csv",
    "Work of one iteration with triangles that face away left out by the CPU, and with all.",
    {{"departure without", key(), as_before, &Culling::departure, &Culling::without},
     {"renderer", shown(), "", &Culling::renderer},
     {"images", exact(), "of the iteration", &Culling::images},
     {"fragments", exact("{:.0f}"), "that reached their targets", &Culling::fragments},
     {"operations", exact("{:.0f}"), "of arithmetic, as the passes declare them", &Culling::operations},
     {"reads", exact("{:.0f}").in("texels"), "fetched, likewise", &Culling::reads},
     {"operations_ratio reads_ratio", ratios("{:.4f}"), "over those with triangles left out", &Culling::operations_ratio, &Culling::reads_ratio},
     {"same_parameters", exact(), "1: both leave the same parameters, to the bit", &Culling::same_parameters}}};

inline const ExperimentEntry experiment{
    .name = "departures",
    .about = "What each of our mends of the paper's text is worth, left out by itself ([docs/paper.md](paper.md#mends)).",
    .files = {&fits, &culling},
    .place = 120,
    .title = "What each of our changes to the paper's text is worth",
    .section = "3, 5",
    .paper = "The equations as printed, and what they leave open (docs/paper.md, Departures). The paper measures none of it.",
    .tables = {"departures.md"}};

}  // namespace radiafit::harness::rows_of::departures
