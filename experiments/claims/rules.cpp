#include "rules.h"

namespace radiafit::harness {
namespace {

constexpr Claim table[] = {
    {"C1", "6.1, Fig. 7", "CG needs about a tenth of SD's iterations",
     "the median, over all problems, of SD's over CG's iterations to 1.01 of the least error any solver found is at "
     "least 5 on both datasets; who doesn't arrive counts as arriving at the cap",
     "fig7_convergence", iteration_ratio},
    {"C2", "6.1", "CG usually finds a better local minimum",
     "300 problems run until E_t falls by less than a millionth in 200 iterations, or for 30,000; a fast method goes "
     "on from there to the minimum: more than 5 % of the minima lie more than 1 % apart, and of those CG's is the "
     "lower in more than half",
     "fig7_convergence", better_minimum},
    {"C3", "6.2, Fig. 8", "the GPU is more than 5 times faster than the CPU, for CG and for SD",
     "both ratios of wall time, distribution included, the faster record, are above 5, against one thread and against "
     "all",
     "fig8_time", faster_than_cpu},
    {"C4", "4.3", "distribution takes up to half of the CPU's time",
     "the largest share, over optimizers and 25 and 100 iterations, with the paper's record: above 35 % holds, below "
     "20 % does "
     "not",
     "fig8_time", distribution_share},
    {"C5", "6.2", "streaming images takes about 20 % of the GPU's time",
     "10 to 30 % of an iteration, from disk with a cold page cache", "fig8_time", streaming_share},
    {"C6", "6.5", "streaming from disk takes about 70 % of the time for the Lafortune model",
     "50 to 90 % of an iteration, from disk with a cold page cache", "streaming", lafortune_streaming},
    {"C7", "6.2", "context switches take about half of SD's time, almost 66 % of CG's",
     "the same commands cut to one texel take 35 to 65 % of SD's iteration, and a larger share of CG's", "fig8_time",
     switching_share},
    {"C8", "6.4, Fig. 9", "nonlinear optimization beats PCA at the same high resolution",
     "PSNR higher and APE lower, one term, training images, the paper's mode, weights chosen on validation views, than "
     "PCA as published and than PCA refilled; means over at least 3 seeds, on star and bust",
     "fig9_error", above_pca},
    {"C9", "6.4, Fig. 9", "the GPU at 16-bit floats about equals the CPU at low resolution",
     "one term, training images, the paper's mode and passes, 16-bit storage and sums: PSNR differs by at most 0.2 dB "
     "after equally many iterations, past which the CPU's gains no more than that; means as for C8",
     "fig9_error", half_as_good},
    {"C10", "6.5, Fig. 10", "29 % utilization for the light field map",
     "none: operations counted over the peaks of the same device are told beside the paper's", "fig10_utilization",
     utilization},
    {"C11", "6.5", "streaming from host memory instead of disk raises utilization",
     "an iteration takes less time in every combination of problem, passes and optimizer", "streaming",
     memory_over_disk},
    {"C12", "6.5", "combining passes cuts the switch overhead and redundant reads",
     "switching time and declared texture reads, image by image, are both at most 0.7 of the paper's passes'",
     "fig8_time", combined_passes},
    {"C13", "4.3", "redistributing every iteration costs almost nothing",
     "time of an iteration that distributes in each sweep over that with samples kept on the device, in OpenGL without "
     "streaming, by the paper's passes and in compute shaders that gather and that scatter, is at most 1.1",
     "scaling", redistribution},
    {"C14", "6.3", "memory is O(N); 142 MB for the star at 32 bits",
     "the bytes of all textures and buffers, as OpenGL tells them, exceed the plan by at most 5 %; slope of log bytes "
     "over log parameters at most 1.05, sides 8 to 32; the paper's layout for the star within 5 % of 142 MB",
     "scaling", memory_linear},
    {"C15", "6.6", "limited scatter and gather would remove the dependence on the sampling rate",
     "slope of log time of sweeps over log texels at fixed images: gather in fragment programs at least 0.5, scatter "
     "in "
     "compute shaders at most 0.2",
     "scaling", gather_and_scatter},
    {"C16", "5.3.2", "threshold stopping rules are too restrictive, and utilization falls as problems finish",
     "with CG under both rules, at some threshold that leaves the median problem above 1.05 of its best error, less "
     "than "
     "half of the problems are active before the median one is within 1.01, or ever; without a threshold the median "
     "problem arrives",
     "stopping", idle_before_arrival},
    {"C17", "5.1.1", "a pixel lands in one texel, and every parameter still gets many samples",
     "with surface maps of sides by their triangles' projected size, where the median image has at least one texel "
     "that faces it per covered pixel: no texel takes two pixels of one image, and the median texel has at least 10 "
     "samples",
     "table1_datasets", pixels_and_texels},
    {"C18", "3.2", "an iteration costs O(S), memory O(N)",
     "slope of log time over log samples at most 1.1, on the CPU and in OpenGL, at least 5 sizes over a factor of 16, "
     "distinct images; slope of log bytes over log parameters at most 1.1",
     "scaling", cost_linear},
    {"C19", "3", "CG has the convergence rate of the Newton method",
     "iterations to 1.01 of the best error, CG's over Newton steps' (variable projection), of the problems where no "
     "bounds "
     "are at work, for those have one objective: median at most 2; not comparable where bounds are at work in more "
     "than a "
     "quarter",
     "fig7_convergence", newton_rate},
    {"C20", "3.2", "regularization and bounds cost a negligible part",
     "at most 5 % of an iteration's time, and of its declared operations; the gradient's last step, which adds them to "
     "the sums over samples, counts as theirs for what holds, and not for what does not hold",
     "fig10_utilization", cheap_penalties},
    {"C21", "6.4", "errors at low resolution are much higher than at high",
     "at least 1 dB of PSNR, one term, training images, the paper's mode, weights chosen for each resolution; means as "
     "for C8",
     "fig9_error", resolution_matters},
    {"C22", "6.1", "the ratio of CG's and SD's iterations is consistent across optimizations and datasets",
     "upper over lower quartile of C1's ratio at most 3, and the two datasets' medians within a factor of 1.5",
     "fig7_convergence", consistent_ratio},
    {"C23", "6.5", "on a Radeon 9700: 20 % streaming, 50 to 66 % switching, the rest computation",
     "none: a model from the declared work of the paper's passes and the peaks the paper states", "fig10_utilization",
     paper_chip},
};

}  // namespace

std::span<const Claim> claims() { return table; }

}  // namespace radiafit::harness
