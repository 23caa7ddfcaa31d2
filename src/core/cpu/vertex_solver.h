#pragma once
#include <functional>
#include <memory>

#include "base/journal.h"
#include "cpu/vertex_options.h"
#include "cpu/vertex_problem.h"
#include "optim/optimizer.h"

/// Step 2 of the CPU baseline (Section 4.3): vertex after vertex to its end with the same optimizer as everywhere, all
/// threads over vertices, so that what a sweep reads and writes stays in the L2 cache.
namespace radiafit {

struct VertexSolution {
    std::vector<float> parameters;         ///< LfmLayout order
    std::vector<ProblemOutcome> outcomes;  ///< [3 vertices]
    ProblemStatistics statistics;          ///< [vertices]
    /// Sums over problems after k trials each; time_s is what all problems took for them, over the threads.
    Trace trace;
    uint64_t sample_iterations = 0;    ///< radiance samples times iterations, over all vertices
    uint64_t largest_working_set = 0;  ///< bytes of a vertex while it is solved
};

/// Where one thread has its vertices from.
class VertexSource {
public:
    virtual ~VertexSource() = default;
    /// Vertices [begin, end) are loaded next, in their order.
    virtual void begin(size_t, size_t) {}
    virtual void load(size_t v, VertexProblem& problem) = 0;
};

/// Solves all vertices of what `statistics` counted; `fresh` has none loaded. `sources` makes one source for each
/// thread. The result does not depend on the number of threads. `progress` is called after every vertex, from any
/// thread.
VertexSolution solve_vertices(const LfmLayout& layout, ProblemStatistics statistics, const VertexProblem& fresh,
                              const VertexSolverOptions& options,
                              const std::function<std::unique_ptr<VertexSource>()>& sources,
                              const std::function<void()>& progress = {});

/// From a list in memory.
VertexSolution solve_vertices(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                              const SampleList& samples, const LfmOptions& model, const VertexSolverOptions& options,
                              const std::function<void()>& progress = {});

/// Bytes that a thread holds of a vertex with so many texels in its maps, of one term, and so many samples.
uint64_t vertex_solver_bytes(size_t texels, size_t samples, int terms, const Room& room);

}  // namespace radiafit
