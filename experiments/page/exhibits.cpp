#include "exhibits.h"

namespace radiafit::harness {

std::span<const Exhibit> exhibits() {
    static const Exhibit table[] = {
        {"table1_datasets",
         "Table 1: the models",
         "6, 6.3, Table 1",
         "Three models: bust, 7,228 triangles and 161 MB of images; star, 6,093 and 159 MB; ornament, 3,690 and 0.98 "
         "GB. "
         "Surface maps of 32 texels and view maps of 8 × 8; of the ornament 128 texels per triangle, nine parameters "
         "each. The counts of parameters, of texture texels and of images are not in our text. The captures are not "
         "public: ours are synthetic stand-ins.",
         "One column for each model and way to choose the sides of its surface maps: an image of it, and below it the "
         "share of its texels that get at most so many "
         "samples, with a mark at 10 samples.",
         "make experiments PROFILE=PROFILE ONLY=table1_datasets",
         {"table1_datasets.md"}},
        {"fig7_convergence",
         "Figure 7: convergence of conjugate gradients and steepest descent",
         "6.1, Figure 7",
         "On three randomly chosen problems conjugate gradients “often” need “an order of magnitude fewer iterations”: "
         "“Optim 2” about 25 against about 250. They usually find “a better local minimum”. The figure's curves are "
         "not "
         "in our text.",
         "A row of four plots for each of star and bust: the error of three problems by iteration, conjugate gradients "
         "solid and steepest descent dashed; the share of all problems by how many times the iterations steepest "
         "descent "
         "needs; the share of problems within 1 % of the best error by iteration, for every solver; and how far apart "
         "the two methods' ends lie.",
         "make experiments PROFILE=PROFILE ONLY=fig7_convergence",
         {"summary.csv"}},
        {"fig8_time",
         "Figure 8: where the time goes",
         "6.2, Figure 8",
         "The star, exactly 100 iterations: a Radeon 9700 is “more than 5 times” faster than a 2 GHz Pentium 4, both "
         "by "
         "steepest descent and by conjugate gradients. Context switches take about half of steepest descent's time and "
         "almost 66 % of conjugate gradients', streaming of images about 20 %. The bars' values are not in our text.",
         "Horizontal bars for each optimizer on the CPU and in OpenGL: left the seconds of a fit on a logarithmic "
         "axis, "
         "right the shares of distribution, optimization, streaming, computation and switching.",
         "make experiments PROFILE=PROFILE ONLY=fig8_time",
         {"times.csv"}},
        {"fig9_error",
         "Figure 9: error of four methods",
         "6.4, Figure 9",
         "One term, the star: nonlinear optimization is better than factorization (PCA) at the same high resolution, "
         "144 "
         "texels in a surface map on average and 256 in a view map. At a low resolution the CPU in 32 bits and the GPU "
         "in "
         "16 bits are “very similar to each other”, their errors “much higher”. The values of PSNR and of the average "
         "pixel error are not in our text.",
         "Bars of PSNR and of the average pixel error of each method, on training and on held-out images of star and "
         "bust; below, PSNR by the number of terms.",
         "make experiments PROFILE=PROFILE ONLY=fig9_error",
         {"fig9_error.md"}},
        {"fig10_utilization",
         "Figure 10: use of the device's peaks",
         "6.5, Figure 10",
         "The light field map reaches 29 % utilization on a Radeon 9700 Pro, whose peaks are 2.6 Gops of arithmetic "
         "and "
         "0.65 Gops of 64-bit texture reads. Streaming from disk takes about 70 % of the ornament's time. The figure's "
         "other bars are not in our text.",
         "Bars for star and ornament, paper's and combined passes, both optimizers: the shares of this device's peaks "
         "of "
         "arithmetic, memory traffic and texture reads.",
         "make experiments PROFILE=PROFILE ONLY=fig10_utilization",
         {"utilization.csv"}},
        {"scaling",
         "Memory and time by the size of the problem",
         "3.2, 4.3, 6.3, 6.6",
         "Memory is O(N), an iteration costs O(S); conjugate gradients on the star need 142 MB at 32 bits. "
         "Redistributing every iteration “has almost no extra cost”. A limited scatter and gather would remove the "
         "dependence on the sampling rate of the parameters.",
         "Four plots with logarithmic axes: memory by the number of parameters; seconds per iteration by the number of "
         "samples; seconds of the sweeps by the number of surface texels, for gathering and scattering; and how much "
         "longer an iteration takes that distributes anew.",
         "make experiments PROFILE=PROFILE ONLY=scaling",
         {"summary.csv"}},
        {"streaming",
         "Where images are streamed from",
         "6.5",
         "Streaming images from host memory in place of the disk, and combining passes, would raise utilization; for "
         "the "
         "ornament streaming from disk takes about 70 % of the time.",
         "Bars of seconds per iteration for light field map and Lafortune's model, by passes, optimizer and where "
         "images "
         "come from: a cold disk, the page cache, memory, or the device.",
         "make experiments PROFILE=PROFILE ONLY=streaming",
         {"times.csv"}},
        {"passes",
         "From the paper's passes to cached samples",
         "6.5, 6.6",
         "Combining passes by multiple render targets and longer programs would cut the cost of context switches and "
         "redundant texture reads. No values are given.",
         "Bars of milliseconds per image and sweep, from the paper's passes down to samples kept on the CPU.",
         "make experiments PROFILE=PROFILE ONLY=passes",
         {"ladder.csv"}},
        {"stopping",
         "Stopping each problem by a threshold",
         "5.3.2",
         "Stopping by a small difference from the target, or by a small change of the output, is “too restrictive”; "
         "and as "
         "problems finish early, utilization falls. No values are given.",
         "A row for conjugate gradients' and steepest descent's two rules: the share of problems that still run by "
         "iteration, for each threshold; below, the median problem's error above its best.",
         "make experiments PROFILE=PROFILE ONLY=stopping",
         {"rules.csv"}},
        {"precision",
         "What 16-bit floats cost",
         "6.3, 6.4",
         "16-bit floats had no “detrimental effect” on convergence. No values are given.",
         "Two plots of how far the error departs from that of 32 bits, by iteration, for conjugate gradients and "
         "steepest "
         "descent; beside them bars of PSNR at the end, less that of 32 bits.",
         "make experiments PROFILE=PROFILE ONLY=precision",
         {"finals.csv"}},
        {"reflectance",
         "Lafortune's model on the ornament",
         "4.2",
         "Nine parameters in every texel are fitted to images under a moving lamp. How well is not in our text.",
         "For each solver: the share of gold, green and white texels whose error is at most 1.05 times Ceres', without "
         "and "
         "with noise; PSNR on held-out images; and texels fitted in a second, on a logarithmic axis.",
         "make experiments PROFILE=PROFILE ONLY=reflectance",
         {"reflectance.md"}},
        {"departures",
         "What each of our changes to the paper's text is worth",
         "3, 5",
         "The equations as printed, and what they leave open (docs/paper.md, Departures). The paper measures none of "
         "it.",
         "",
         "make experiments PROFILE=PROFILE ONLY=departures",
         {"departures.md"}},
        {"solvers",
         "Solvers side by side",
         "",
         "",
         "Bars of processor time per vertex until its three problems are within 1 % of the least error, one for each "
         "solver, on a logarithmic axis.",
         "make experiments PROFILE=PROFILE ONLY=solvers",
         {"solvers.csv"}},
        {"peers",
         "PyTorch on the same problems",
         "",
         "",
         "PSNR of held-out samples over seconds of solving, one curve for each of our solvers and of PyTorch's.",
         "make peers PROFILE=PROFILE",
         {"peers.csv"}},
        {"captures", "Real captures", "", "", "", "make experiments PROFILE=PROFILE ONLY=captures", {"captures.md"}},
    };
    return table;
}

}  // namespace radiafit::harness
