#pragma once
#include "cpu/vertex_problem.h"
#include "optim/optimizer.h"

namespace radiafit {

struct TwoStepOptions {
    OptimizerOptions optimizer;
    bool deflate = false;  ///< terms one after another
    uint64_t seed = 1;     ///< of lfm_start
};

struct TwoStepResult {
    std::vector<float> parameters;         ///< LfmLayout order
    std::vector<ProblemOutcome> outcomes;  ///< [3 vertices]
    ProblemStatistics statistics;          ///< [vertices]
    /// Sums over problems after k trials each; time_s is what all problems took for them, over the threads.
    Trace trace;
    double read_s = 0;  ///< of the threads, reading records, over the threads
    uint64_t bytes_read = 0;
    uint64_t sample_iterations = 0;  ///< radiance samples times iterations, over all vertices
    uint64_t largest_working_set = 0;
};

/// Step 2 of the CPU baseline (Section 4.3): vertex after vertex is read and solved to its end with the same optimizer
/// as everywhere, all threads over vertices. The result does not depend on the number of threads. `progress` is called
/// after every vertex, from any thread.
TwoStepResult solve_two_step(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const DiskRecords& records, const LfmOptions& options, const TwoStepOptions& two_step,
                             const std::function<void()>& progress = {});

}  // namespace radiafit
