#pragma once
#include <optional>
#include <span>

#include "app/solve.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"

/// The solvers that `--solver` names: one table, one function each.
namespace radiafit {

/// One fit as its solver sees it.
class FitTask {
public:
    const Dataset& dataset;
    const FitRequest& request;
    const TriangleAtlas& atlas;
    const VertexRings& rings;
    const std::vector<uint32_t>& views;  ///< to fit
    const IterationHook& each_iteration;
    LfmOptions options;  ///< of the model that is fitted; a solver with a smaller one of its own says so here
    FitOutcome& out;

    FitTask(const Dataset& dataset, const FitRequest& request, const TriangleAtlas& atlas, const VertexRings& rings,
            const std::vector<uint32_t>& views, const IterationHook& each_iteration, const SharedSamples* shared,
            FitOutcome& out);
    /// The shared list, or one distributed at the first call and timed as distribution.
    const SampleList& samples();
    LfmLayout layout() const;

private:
    const SharedSamples* shared_;
    std::optional<SharedSamples> own_;
};

struct Solver {
    const char* name;
    const char* help;
    void (*solve)(FitTask& task);  ///< fills out.fit's parameters and problems, and out.times
};
std::span<const Solver> solvers();

void solve_stream(FitTask& task);
void solve_mean(FitTask& task);

/// For solvers that return parameters only: fills the fit's problems (raw E, samples, the given status and iterations)
/// by evaluating the model once over the samples. Problems without samples say so whatever `status` is.
void fill_problems(FitTask& task, std::vector<float> parameters, Status status, uint32_t iterations);

}  // namespace radiafit
