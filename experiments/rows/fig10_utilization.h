#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::fig10_utilization {
using namespace columns;

struct Iteration {
    std::string problem, optimizer, passes;
    size_t repetition;
    double seconds, penalties_s, cached_share;
};
inline const RowFileOf<Iteration> iterations{
    "iterations.csv",
    "One row for each iteration that was timed.",
    {{"problem", key(), "light field map or Lafortune", &Iteration::problem},
     {"optimizer", key(), "sd or cg", &Iteration::optimizer},
     {"passes", key(), "paper or combined", &Iteration::passes},
     {"repetition", repetition(), "from 0", &Iteration::repetition},
     {"seconds", times("{:.5g}"), "", &Iteration::seconds},
     {"penalties_s", times("{:.5g}"), "from the last image to the finished gradient or line: penalties, and the gradient's last step", &Iteration::penalties_s},
     {"cached_share", shown("{:.5g}").in("share"), "of the images' pages in the page cache", &Iteration::cached_share}}};

struct Work {
    std::string problem, optimizer, passes;
    uint64_t operations, reads, bytes, switches, image_bytes, penalty_operations, shared_operations;
};
inline const RowFileOf<Work> work{
    "work.csv",
    "What one iteration asks of the device: sums over passes.csv.",
    {{"problem optimizer passes", key(), as_before, &Work::problem, &Work::optimizer, &Work::passes},
     {"operations", exact(), "components of arithmetic, as the passes declare them, times their fragments", &Work::operations},
     {"reads", exact().in("texels"), "fetched, likewise", &Work::reads},
     {"bytes", memory(), "read, written, blended and cleared", &Work::bytes},
     {"switches", exact(), "changes of the framebuffer", &Work::switches},
     {"image_bytes", memory(), "of images that are streamed", &Work::image_bytes},
     {"penalty_operations shared_operations", exact(), "of passes for penalties alone, and of those that also finish the gradient", &Work::penalty_operations, &Work::shared_operations}}};

struct Pass {
    std::string problem, optimizer, passes, program;
    uint64_t draws, fragments, entries, operations, reads, read_bytes, written_bytes, blended_bytes;
};
inline const RowFileOf<Pass> passes{
    "passes.csv",
    "The work of one iteration by program.",
    {{"problem optimizer passes", key(), as_before, &Pass::problem, &Pass::optimizer, &Pass::passes},
     {"program", key(), "its fragment stage and definitions", &Pass::program},
     {"draws", exact(), "", &Pass::draws},
     {"fragments", exact(), "that reached their targets", &Pass::fragments},
     {"entries", exact(), "turns of the program's loop, in all fragments", &Pass::entries},
     {"operations", exact(), "of arithmetic", &Pass::operations},
     {"reads", exact().in("texels"), "fetched", &Pass::reads},
     {"read_bytes", memory(), "fetched", &Pass::read_bytes},
     {"written_bytes blended_bytes", memory(), "to targets; of these, added to what stood there", &Pass::written_bytes, &Pass::blended_bytes}}};

struct Peak {
    std::string device, peak;
    size_t repetition;
    double per_second;
};
inline const RowFileOf<Peak> peaks{
    "peaks.csv",
    "What the devices can do at most, measured before every round.",
    {{"device", device(), "", &Peak::device},
     {"peak", key(), "what of", &Peak::peak},
     {"repetition", repetition(), "from 0", &Peak::repetition},
     {"per_second", shown("{:.5g}").in("1/s"), "", &Peak::per_second}}};

struct Bar {
    std::string problem, optimizer, passes;
    double computation_share;
    std::optional<double> computation_low, computation_high;
    double bandwidth_share;
    std::optional<double> bandwidth_low, bandwidth_high;
    double reads_share;
    std::optional<double> reads_low, reads_high;
    double seconds_per_iteration;
    size_t repetitions;
    std::string source, renderer;
};
inline const RowFileOf<Bar> utilization{
    "utilization.csv",
    "The bars of the figure: medians over repetitions, each by the peaks of its own round.",
    {{"problem optimizer passes", key(), as_before, &Bar::problem, &Bar::optimizer, &Bar::passes},
     {"computation_share computation_low computation_high", shown("{:.5g}").in("share"), "of the same device's peak of arithmetic, and its interval of 95 %", &Bar::computation_share,
      &Bar::computation_low, &Bar::computation_high},
     {"bandwidth_share bandwidth_low bandwidth_high", shown("{:.5g}").in("share"), "likewise of memory traffic", &Bar::bandwidth_share, &Bar::bandwidth_low, &Bar::bandwidth_high},
     {"reads_share reads_low reads_high", shown("{:.5g}").in("share"), "likewise of texture reads", &Bar::reads_share, &Bar::reads_low, &Bar::reads_high},
     {"seconds_per_iteration", shown("{:.5g}").in("s"), "median", &Bar::seconds_per_iteration},
     {"repetitions", shown(), "", &Bar::repetitions},
     {"source", shown(), "where images come from", &Bar::source},
     {"renderer", shown(), "", &Bar::renderer}}};

inline const ExperimentEntry experiment{
    .name = "fig10_utilization",
    .about = "Figure 10: use of the device's peaks of arithmetic, memory traffic and texture reads, measured in the same run, by the declared cost of every pass.",
    .files = {&iterations, &work, &passes, &peaks, &utilization},
    .place = 50,
    .title = "Figure 10: use of the device's peaks",
    .section = "6.5, Figure 10",
    .paper =
        "The light field map reaches 29 % utilization on a Radeon 9700 Pro, whose peaks are 2.6 Gops of arithmetic and 0.65 Gops of 64-bit texture reads. Streaming from disk takes about 70 % of the "
        "ornament's time. The figure's other bars are not in our text.",
    .figure = "Bars for star and ornament, paper's and combined passes, both optimizers: the shares of this device's peaks of arithmetic, memory traffic and texture reads.",
    .tables = {"utilization.csv"}};

}  // namespace radiafit::harness::rows_of::fig10_utilization
