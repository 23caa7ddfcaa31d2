#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::reflectance {
using namespace columns;

// Distances from the truth of noise-free images are down to the last digits of 32 bits.
struct Fit {
    std::string images, method, renderer;
    int iterations;
    std::string group;
    size_t texels;
    std::optional<double> worst_error_median, recovered_share;
    double within_share, rms_error, iterations_median;
};
inline const RowFileOf<Fit> fits{
    "fits.csv",
    "One row for each set of images, method and group of texels.",
    {{"images", key(), "noise-free or noisy", &Fit::images},
     {"method", key(), "", &Fit::method},
     {"renderer", shown(), "", &Fit::renderer},
     {"iterations", exact(), "most that the method may take", &Fit::iterations},
     {"group", key(), "of texels: by material, or by how sharp their lobes are", &Fit::group},
     {"texels", exact(), "in it that have enough samples", &Fit::texels},
     {"worst_error_median", errors("{:.4g}", 0.01), "the largest relative error of a texel's nine parameters; median over texels; empty where the truth is of another model", &Fit::worst_error_median},
     {"recovered_share", shares("{:.5f}"), "of the texels whose worst error is below `recovered` in run.json; empty likewise", &Fit::recovered_share},
     {"within_share", shares("{:.5f}"), "of the texels whose residual is at most `within` times Ceres'", &Fit::within_share},
     {"rms_error", errors("{:.4g}", 0.01).in("white = 1"), "root mean square residual of the group's samples, in training images", &Fit::rms_error},
     {"iterations_median", iterations("{}"), "that texels took", &Fit::iterations_median}}};

struct Time {
    std::string images, method, renderer, distributes;
    uint64_t texels, samples;
    double distribution_s, load_s, solve_s, fits_per_s, ns_per_sample_iteration;
};
inline const RowFileOf<Time> times{
    "times.csv",
    "One row for each set of images and method.",
    {{"images method", key(), as_before, &Time::images, &Time::method},
     {"renderer", shown(), "", &Time::renderer},
     {"distributes", exact(), "once, before the fit; or every sweep over the images", &Time::distributes},
     {"texels samples", exact(), "that are fitted", &Time::texels, &Time::samples},
     {"distribution_s", columns::times("{:.4g}"), "of distributing once; 0 where every sweep does", &Time::distribution_s},
     {"load_s", columns::times("{:.4g}"), "of reading samples, or images, and shading them", &Time::load_s},
     {"solve_s", columns::times("{:.4g}"), "from samples at hand to parameters and their errors", &Time::solve_s},
     {"fits_per_s", shown("{:.4g}").in("1/s"), "texels over solve_s", &Time::fits_per_s},
     {"ns_per_sample_iteration", shown("{:.4g}").in("ns"), "solve_s over samples and iterations", &Time::ns_per_sample_iteration}}};

struct Part {
    std::string images, method, renderer, part;
    uint64_t pixels;
    double held_psnr_db, held_ape;
};
inline const RowFileOf<Part> pictures{
    "images.csv",
    "Held-out images by the fits of each method.",
    {{"images method", key(), as_before, &Part::images, &Part::method},
     {"renderer", shown(), "", &Part::renderer},
     {"part", key(), "of the surface: a material, or all", &Part::part},
     {"pixels", exact(), "that were judged", &Part::pixels},
     {"held_psnr_db", decibels("{:.4f}"), "", &Part::held_psnr_db},
     {"held_ape", errors("{:.4f}").in("1/255"), "", &Part::held_ape}}};

struct Arrival {
    std::string method;
    int iterations;
    size_t texels;
    double arrived_share, seconds, seconds_least, seconds_most;
    size_t repetitions;
    std::string precision;
    int together;
    std::string instructions;
};
inline const RowFileOf<Arrival> arrivals{
    "arrival.csv",
    "One row for each method and most iterations that it may take, on some of the texels of the noisy images, by one thread: what the report's table of rivals is of.",
    {{"method", key(), "", &Arrival::method},
     {"iterations", key(), "at most", &Arrival::iterations},
     {"texels", work(), "with enough samples", &Arrival::texels},
     {"arrived_share", ColumnType{{ColumnKind::absolute, 0.01}, "{:.5f}", "share"}, "of them within 1 % of the least error that any fit left them", &Arrival::arrived_share},
     {"seconds seconds_least seconds_most", shown("{:.5g}").in("s"),
      "of all of them, from samples at hand to parameters and their errors, by a fit of so many iterations at most: median, least and most of the repetitions", &Arrival::seconds,
      &Arrival::seconds_least, &Arrival::seconds_most},
     {"repetitions", shown(), "", &Arrival::repetitions},
     {"precision", shown(), "of its arithmetic, in bits", &Arrival::precision},
     {"together", shown(), "problems that a register holds side by side", &Arrival::together},
     {"instructions", shown(), "that its loops are compiled for; Ceres' own loops are those of Debian's library, the costs that it calls ours", &Arrival::instructions}}};

inline const ExperimentEntry experiment{
    .name = "reflectance",
    .about =
        "Sections 4.2 and 6.5: Lafortune's nine parameters per texel on the ornament: which solver finds the truth, which as low an error as Ceres, of the optimizers, Ceres, its TinySolver, and "
        "variable projection given to Ceres, by sharpness of the lobe, and how many texels it fits in a second; and after what time which share of the texels has arrived.",
    .files = {&fits, &times, &pictures, &arrivals},
    .place = 110,
    .title = "Lafortune's model on the ornament",
    .section = "4.2",
    .paper = "Nine parameters in every texel are fitted to images under a moving lamp. How well is not in our text.",
    .figure =
        "For each solver: the share of gold, green and white texels whose error is at most 1.05 times Ceres', without and with noise; PSNR on held-out images; and texels fitted in a second, on a "
        "logarithmic axis.",
    .tables = {"reflectance.md"}};

}  // namespace radiafit::harness::rows_of::reflectance
