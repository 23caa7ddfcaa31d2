#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::streaming {
using namespace columns;

struct Iteration {
    std::string problem, passes, source;
    size_t repetition;
    double line_s, line_streaming_s, direction_s, direction_streaming_s, cached_share;
};
inline const RowFileOf<Iteration> iterations{
    "iterations.csv",
    "One row for each repetition: one iteration of conjugate gradients, of which steepest descent takes the direction alone.",
    {{"problem", key(), "light field map or Lafortune", &Iteration::problem},
     {"passes", key(), "paper or combined", &Iteration::passes},
     {"source", key(), "disk-cold, disk (from the page cache), memory or device", &Iteration::source},
     {"repetition", repetition(), "from 0", &Iteration::repetition},
     {"line_s line_streaming_s direction_s direction_streaming_s", times("{:.5g}"), "of the two halves, a sweep over the images each; of these: reading images and handing them to OpenGL",
      &Iteration::line_s, &Iteration::line_streaming_s, &Iteration::direction_s, &Iteration::direction_streaming_s},
     {"cached_share", shown("{:.5g}").in("share"), "of the images' pages in the page cache", &Iteration::cached_share}}};

struct Bar {
    std::string problem, passes, optimizer, source;
    double seconds_per_iteration;
    std::optional<double> low_s, high_s;
    double streaming_s, streaming_share, over_disk_cold;
    size_t repetitions;
    std::string renderer;
};
inline const RowFileOf<Bar> times{
    "times.csv",
    "Medians of these.",
    {{"problem passes", key(), as_before, &Bar::problem, &Bar::passes},
     {"optimizer", key(), "sd or cg", &Bar::optimizer},
     {"source", key(), as_before, &Bar::source},
     {"seconds_per_iteration low_s high_s", shown("{:.5g}").in("s"), "median, and its interval of 95 %", &Bar::seconds_per_iteration, &Bar::low_s, &Bar::high_s},
     {"streaming_s", shown("{:.5g}").in("s"), "of reading images and handing them to OpenGL", &Bar::streaming_s},
     {"streaming_share", shown("{:.5g}").in("share"), "of the iteration", &Bar::streaming_share},
     {"over_disk_cold", shown("{:.5g}"), "the time over that from a cold disk, round by round", &Bar::over_disk_cold},
     {"repetitions", shown(), "", &Bar::repetitions},
     {"renderer", shown(), "", &Bar::renderer}}};

inline const ExperimentEntry experiment{
    .name = "streaming",
    .about = "Section 6.5: the time of an iteration with images from a cold disk, the page cache, host memory, or kept on the device.",
    .files = {&iterations, &times},
    .place = 70,
    .title = "Where images are streamed from",
    .section = "6.5",
    .paper = "Streaming images from host memory in place of the disk, and combining passes, would raise utilization; for the ornament streaming from disk takes about 70 % of the time.",
    .figure = "Bars of seconds per iteration for light field map and Lafortune's model, by passes, optimizer and where images come from: a cold disk, the page cache, memory, or the device.",
    .tables = {"times.csv"}};

}  // namespace radiafit::harness::rows_of::streaming
