#pragma once
#include "cpu/vertex_solver.h"
#include "samples/disk_records.h"

namespace radiafit {

struct TwoStepResult : VertexSolution {
    double read_s = 0;  ///< of the threads, reading records, over the threads
    uint64_t bytes_read = 0;
};

/// Step 2 of the CPU baseline (Section 4.3) from records on disk. `progress` as for solve_vertices().
TwoStepResult solve_two_step(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const DiskRecords& records, const LfmOptions& model, const VertexSolverOptions& options,
                             const std::function<void()>& progress = {});

}  // namespace radiafit
