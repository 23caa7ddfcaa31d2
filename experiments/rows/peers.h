#pragma once
#include "report/experiments.h"

/// experiments/peers writes these rows, in Python.
namespace radiafit::harness::rows_of::peers {
using namespace columns;

// PyTorch's sums differ with its version and its threads; the iteration at which it arrives may, too.
inline const RowFile curves{
    "curves.csv",
    "One row for each point on the way: of PyTorch after every step of one descent, whose clock stands still meanwhile; of ours after fits of so many iterations each.",
    {{"setting library solver", key(), as_before},
     {"iteration", key(), ""},
     {"seconds", shown().in("s"), "of solving"},
     {"psnr_db", rough_decibels(""), ""},
     {"error", errors("", 0.01).in("E_t"), "the sum over all problems"}},
    partial};

inline const RowFile times{
    "times.csv",
    "One row for each repetition of each.",
    {{"setting library solver", key(), as_before},
     {"repetition", repetition(), ""},
     {"iterations", work(), "that were timed"},
     {"seconds", columns::times(""), as_before},
     {"setup_s", columns::times(""), as_before},
     {"psnr_db", rough_decibels(""), "at the end"}}};

inline const RowFile peers{
    "peers.csv",
    "One row for each setting and solver: medians, and the least and the most, of the repetitions.",
    {{"setting", key(), "maps and weights, by their name in torch_peers.toml"},
     {"library", key(), "PyTorch or radiafit"},
     {"solver", key(), "Adam with its rate, L-BFGS, or one of ours"},
     {"reached", exact(), "1: it arrives within the iterations that it is given"},
     {"iterations", work(), "that were timed: to arrive, or all"},
     {"psnr_db", rough_decibels(""), "that it came to"},
     {"target_db converged_db", rough_decibels(""), "to reach, and of the converged fit"},
     {"seconds seconds_least seconds_most", shown().in("s"), "of solving, from the start values"},
     {"times_ours times_ours_least times_ours_most", shown(), "over those of our quickest solver that arrives, in the same repetition"},
     {"setup_s setup_s_least setup_s_most", shown().in("s"), "before that: ours reads images and distributes their samples; PyTorch, measured once, has the exported problems written and reads them"},
     {"repetitions", shown(), ""},
     {"renderer", shown(), ""}}};

inline const ExperimentEntry experiment{
    .name = "peers",
    .about =
        "PyTorch's Adam and L-BFGS beside our own fits, on the problems of [problems.md](problems.md); `make peers` runs it, `make experiments` does not. PyTorch is Debian's, on the CPU, with as "
        "many threads as our fits: all vertices in one graph, 32-bit floats, gradients by autograd, gathers and embeddings; Adam with the quickest of several rates, which are tried beforehand, "
        "L-BFGS with line searches by the strong Wolfe conditions. PSNR is of the samples of held-out views, of everybody's parameters by the same code. To arrive is to come within 0.02 dB "
        "(`short_db`) of a converged fit's, or above: fits pass through better figures than they end with. A setting is the maps and the weights of their smoothness. Everybody is timed by turns, "
        "with the fewest iterations that arrive; who does not arrive is timed once, with all.",
    .files = {&peers, &times, &curves},
    .place = 140,
    .title = "PyTorch on the same problems",
    .figure = "PSNR of held-out samples over seconds of solving, one curve for each of our solvers and of PyTorch's.",
    .tables = {"peers.csv"},
    .target = "peers"};

}  // namespace radiafit::harness::rows_of::peers
