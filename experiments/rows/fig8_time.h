#pragma once
#include "report/experiments.h"

namespace radiafit::harness::rows_of::fig8_time {
using namespace columns;

struct Repetition {
    std::string method, optimizer;
    int threads, iterations;
    size_t repetition;
    double distribution_s, streaming_s, optimization_s, total_s, iteration_s, error, cached_share;
};
inline const RowFileOf<Repetition> repetitions{
    "repetitions.csv",
    "One row for each whole fit that was timed.",
    {{"method", key(), "two-step, the CPU baseline, with its kind of record; or OpenGL with its kind of passes", &Repetition::method},
     {"optimizer", key(), "cg or sd", &Repetition::optimizer},
     {"threads", key(), "of the CPU", &Repetition::threads},
     {"iterations", key(), "of the fit", &Repetition::iterations},
     {"repetition", repetition(), "round, from 0; in limited time slow methods sit out of some", &Repetition::repetition},
     {"distribution_s", times("{:.5g}"), "of the baseline's first step, which writes samples by vertex", &Repetition::distribution_s},
     {"streaming_s", times("{:.5g}"), "of reading images (OpenGL) or records (the baseline)", &Repetition::streaming_s},
     {"optimization_s", times("{:.5g}"), "of the rest", &Repetition::optimization_s},
     {"total_s", times("{:.5g}"), "wall time", &Repetition::total_s},
     {"iteration_s", times("{:.5g}"), "of an iteration; of OpenGL the mean of those after the first", &Repetition::iteration_s},
     {"error", errors("{:.8g}").in("E_t"), "the sum over problems at the end", &Repetition::error},
     {"cached_share", shown("{:.5g}").in("share"), "of the pages read that were in the page cache", &Repetition::cached_share}},
    partial};  // on a software renderer OpenGL runs fewer repetitions

struct Iteration {
    std::string method, optimizer;
    size_t repetition;
    double seconds, streaming_s, switching_s, cached_share;
};
inline const RowFileOf<Iteration> iterations{
    "iterations.csv",
    "One row for each iteration that was timed by itself.",
    {{"method", key(), "as in repetitions.csv; combined passes also with one image at a time", &Iteration::method},
     {"optimizer", key(), as_before, &Iteration::optimizer},
     {"repetition", repetition(), "from 0", &Iteration::repetition},
     {"seconds", times("{:.5g}"), "", &Iteration::seconds},
     {"streaming_s", times("{:.5g}"), "of it: reading images and handing them to OpenGL", &Iteration::streaming_s},
     {"switching_s", times("{:.5g}"), "of the same commands cut to one texel", &Iteration::switching_s},
     {"cached_share", shown("{:.5g}").in("share"), "of the images' pages in the page cache", &Iteration::cached_share}}};

struct Work {
    std::string method, optimizer;
    uint64_t operations, reads, draws, switches;
};
inline const RowFileOf<Work> work{
    "work.csv",
    "What one iteration asks of the device.",
    {{"method", key(), "as in iterations.csv", &Work::method},
     {"optimizer", key(), as_before, &Work::optimizer},
     {"operations", exact(), "components of arithmetic, as the passes declare them, times their fragments", &Work::operations},
     {"reads", exact().in("texels"), "fetched, likewise", &Work::reads},
     {"draws switches", exact(), "draw calls, and changes of the framebuffer", &Work::draws, &Work::switches}}};

struct Bar {
    std::string method, optimizer;
    int threads, iterations, timed_iterations;
    double distribution_s, streaming_s, computation_s, switching_s, remainder_s, total_s;
    std::optional<double> low_s, high_s;
    size_t repetitions;
    double error, agreeing_share;
    uint64_t bytes_written, bytes_read;
    std::string source, renderer;
};
inline const RowFileOf<Bar> times{
    "times.csv",
    "One row for each bar of the figure: medians over repetitions.",
    {{"method optimizer threads", key(), as_before, &Bar::method, &Bar::optimizer, &Bar::threads},
     {"iterations", key(), "that the bar is for", &Bar::iterations},
     {"timed_iterations", columns::work(), "that were timed: if fewer, the rest counts as they did", &Bar::timed_iterations},
     {"distribution_s streaming_s computation_s switching_s", shown("{:.4f}").in("s"), "parts of the total", &Bar::distribution_s, &Bar::streaming_s, &Bar::computation_s, &Bar::switching_s},
     {"remainder_s", shown("{:.4f}").in("s"), "of the total that is none of these", &Bar::remainder_s},
     {"total_s", shown("{:.4f}").in("s"), "median", &Bar::total_s},
     {"low_s high_s", shown("{:.5g}").in("s"), "its interval of 95 %", &Bar::low_s, &Bar::high_s},
     {"repetitions", shown(), "", &Bar::repetitions},
     {"error", errors("{:.8g}").in("E_t"), "the sum over problems at the end", &Bar::error},
     {"agreeing_share", shares("{:.4f}"), "of the vertices whose error at the end is the CPU engine's within 1e-4", &Bar::agreeing_share},
     {"bytes_written bytes_read", memory(), "of records", &Bar::bytes_written, &Bar::bytes_read},
     {"source", shown(), "where images come from", &Bar::source},
     {"renderer", shown(), "", &Bar::renderer}}};

inline const ExperimentEntry experiment{
    .name = "fig8_time",
    .about = "Figure 8: where the time goes: the CPU's two steps, distribution and optimization, against OpenGL's streaming, computation and switching.",
    .files = {&repetitions, &iterations, &work, &times},
    .place = 30,
    .title = "Figure 8: where the time goes",
    .section = "6.2, Figure 8",
    .paper =
        "The star, exactly 100 iterations: a Radeon 9700 is “more than 5 times” faster than a 2 GHz Pentium 4, both by steepest descent and by conjugate gradients. Context switches take about half "
        "of steepest descent's time and almost 66 % of conjugate gradients', streaming of images about 20 %. The bars' values are not in our text.",
    .figure =
        "For each optimizer, on the CPU and in OpenGL: left dots, the seconds of a fit on a logarithmic axis; right bars, the shares of distribution, optimization, streaming, computation and "
        "switching.",
    .tables = {"times.csv"}};

}  // namespace radiafit::harness::rows_of::fig8_time
