#pragma once
#include <functional>
#include <memory>

#include "base/journal.h"
#include "cpu/texel_fit.h"
#include "model/texel_options.h"
#include "optim/optimizer.h"
#include "samples/texel_loader.h"
#include "samples/texel_source.h"

namespace radiafit {

struct SurfacePrior;

/// A texel-local model fitted to every texel of an atlas.
struct TexelResult {
    std::vector<float> parameters;  ///< [texels][model.parameters], canonical gauge
    std::vector<Status> status;     ///< [texels]
    std::vector<uint32_t> iterations, samples;
    std::vector<float> error;  ///< raw E = 1/2 sum r^2 at `parameters`
    /// Sums over texels of E / samples (streamed optimizers: E_t) after k trials; times of solve_texels() are what all
    /// texels took for them, over the threads.
    Trace trace;
    uint64_t engine_bytes = 0;
    uint64_t sample_iterations = 0;  ///< samples times iterations, over all texels
    double load_s = 0;               ///< reading samples and shading them; over the threads
};

/// Where texels' samples come from, and what counts.
struct TexelProblem {
    const TexelSource& source;
    const TexelLoader& loader;
    const TexelOptions& options;
    Journal* journal = nullptr;  ///< of blocks that solve() and solve_lm() have finished
};

using TexelHook = std::function<void(int iteration, const std::function<void(std::span<float>)>& read_errors)>;

/// The solvers of one model on the CPU. Results depend on no number of threads.
class TexelSolvers {
public:
    virtual ~TexelSolvers() = default;
    /// Every pass over all texels, whose samples stay in memory.
    virtual TexelResult stream(const TexelProblem& problem, const OptimizerOptions& optimizer,
                               const TexelHook& each_iteration) const = 0;
    /// Eight texels after eight texels, each to its end, by the same optimizers. `progress`: after every block.
    virtual TexelResult solve(const TexelProblem& problem, const OptimizerOptions& optimizer,
                              const std::function<void()>& progress) const = 0;
    /// The same by batched Levenberg-Marquardt. prior, if given, counts beside the samples (cpu/surface_prior.h);
    /// texels without samples, or with one that is not finite, get its means.
    virtual TexelResult solve_lm(const TexelProblem& problem, const TexelFitOptions& fit,
                                 const std::function<void()>& progress, const SurfacePrior* prior = nullptr) const = 0;
    /// Where optimizers begin: the best of the model's starts, for eight texels [8][parameters].
    virtual std::vector<float> start(const std::vector<std::vector<ShadedSample>>& texels) const = 0;
    /// Raw E of given parameters [texels][parameters], by which any other solver can be judged alike.
    /// load_s, if given, grows by what TexelResult says of it.
    virtual std::vector<float> errors(const TexelProblem& problem, std::span<const float> parameters,
                                      double* load_s = nullptr) const = 0;
    /// Bytes that stream() holds for so many texels and samples, at least: rows are padded to the longest of eight.
    virtual uint64_t stream_bytes(uint64_t texels, uint64_t samples, const Room& room) const = 0;
};
/// Throws std::invalid_argument for a model that has none.
const TexelSolvers& texel_solvers(const TexelModel& model);
/// Those of a model that was added to the library's (add_texel_model()).
void add_texel_solvers(const TexelModel& model, std::unique_ptr<const TexelSolvers> solvers);

}  // namespace radiafit
