#pragma once
#include "report/experiments.h"

/// experiments/peers writes these rows, in Python.
namespace radiafit::harness::rows_of::peers {
using namespace columns;

// PyTorch's sums differ with its version and its threads; the iteration at which it arrives may, too.
inline const RowFile curves{
    "curves.csv",
    "One row for each point on the way: of PyTorch after every step of one descent, whose clock stands still meanwhile; of SciPy after as many steps of each of its problems, and their times added "
    "up; of ours after fits of so many iterations each.",
    {{"setting library solver", key(), as_before},
     {"iteration", key(), ""},
     {"seconds", shown().in("s"), "of solving"},
     {"psnr_db", rough_decibels(""), ""},
     {"error", errors("", 0.01).in("E_t"), "the sum over the problems that were solved"}},
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
    {{"setting", key(), "maps and weights, by their name in peers.toml"},
     {"library", key(), "PyTorch, SciPy or radiafit"},
     {"solver", key(), "Adam with its rate, L-BFGS, LM (Levenberg-Marquardt) in all parameters or by projection; SciPy's methods; or one of ours"},
     {"reached", exact(), "1: it arrives within the iterations that it is given, and of PyTorch within 120 s (`most_seconds`)"},
     {"iterations", work(), "that were timed: to arrive, or all"},
     {"psnr_db", rough_decibels(""), "that it came to; of SciPy in the triangles that it has all corners of"},
     {"target_db converged_db", rough_decibels(""), "to reach, and of the converged fit, ours; of SciPy's rows in those triangles"},
     {"seconds seconds_least seconds_most", shown().in("s"), "of solving, from the start values"},
     {"times_ours times_ours_least times_ours_most", shown(), "over those of our quickest solver that arrives, in the same repetition; empty for who solves other problems"},
     {"setup_s setup_s_least setup_s_most", shown().in("s"),
      "before that: ours reads images and distributes their samples; PyTorch, measured once, has the exported problems written and reads them, and LM puts them into batches; SciPy, which reads "
      "nothing anew, sorts their samples"},
     {"repetitions", shown(), ""},
     {"renderer", shown(), ""},
     {"precision", shown(), "of the arithmetic, in bits"},
     {"batch", shown(),
      "problems whose numbers go through the arithmetic side by side: of PyTorch's Adam and L-BFGS all in one graph, of LM those of the largest batch; of ours a vertex's channels in one register; of "
      "SciPy one"},
     {"problems", shown(), "that were solved in these seconds"}}};

inline const ExperimentEntry experiment{
    .name = "peers",
    .about =
        "PyTorch and SciPy beside our own fits, on the problems of [problems.md](problems.md); `make peers` runs it, `make experiments` does not. All are Debian's, on the CPU.\n\n"
        "PyTorch, with as many threads as our fits and in 32-bit floats: Adam with the quickest of several rates, which are tried beforehand, and L-BFGS, whose line search by the strong Wolfe "
        "conditions has one step length for all problems, both with all vertices in one graph of gathers and embeddings and gradients by autograd; and Levenberg-Marquardt, with a damping and a "
        "verdict for each problem, by `torch.linalg` over batches of vertices, the surface maps eliminated from each step (Schur complement), as it is and by variable projection, where the surface "
        "maps then follow each trial of the view map in closed form. A batch goes on until its last problem is finished, so that PyTorch's times are upper bounds.\n\n"
        "SciPy's `least_squares`, in 64 bits, one thread and one problem after another, has analytic Jacobians: `lm`, which is MINPACK's, dense ones, and `trf` sparse ones, with hard bounds in place "
        "of their penalty. It takes a few problems alone, a vertex that is drawn and those around it: its rows say of how many they are, its PSNR is of the triangles between them, and stands beside "
        "that of our converged fit in the same triangles, of which it may fall short by 0.2 dB (`scipy_short_db`), as few problems that end in other minima tell. No time of few problems is scaled up "
        "to that of all.\n\n"
        "PSNR is of the samples of held-out views, of everybody's parameters by the same code. To arrive is to come within 0.02 dB (`short_db`) of a converged fit's, or above: fits pass through "
        "better "
        "figures than they end with. A setting is the maps and the weights of their smoothness. Everybody is timed by turns, with the fewest iterations that arrive; who does not arrive is timed "
        "once, "
        "with all (PyTorch for 120 s, `most_seconds`), and SciPy once, on its way. Whose ratio is algorithm and whose is engineering, `precision`, `batch` and the same method on both sides tell: "
        "variable projection is in PyTorch's "
        "rows "
        "and in ours.",
    .files = {&peers, &times, &curves},
    .place = 140,
    .title = "PyTorch and SciPy on the same problems",
    .figure = "PSNR of held-out samples over seconds of solving, one curve for each of our solvers and of PyTorch's; SciPy's few problems in words.",
    .tables = {"peers.csv"},
    .target = "peers"};

}  // namespace radiafit::harness::rows_of::peers
