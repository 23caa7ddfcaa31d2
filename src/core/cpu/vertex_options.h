#pragma once
#include <cstdint>

#include "optim/methods.h"

namespace radiafit {

class Journal;

struct VertexSolverOptions {
    OptimizerOptions optimizer;
    bool deflate = false;        ///< terms one after another
    uint64_t seed = 1;           ///< of lfm_start
    Journal* journal = nullptr;  ///< of vertices that are finished, if they are kept
};

}  // namespace radiafit
