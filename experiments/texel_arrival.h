#pragma once
#include <vector>

#include "dataset/dataset.h"
#include "engineering.h"
#include "fitting/solvers/solve.h"
#include "rows/reflectance.h"

namespace radiafit::harness {

/// One solver on its way: fits of so many iterations at most each.
struct Climber {
    std::string name;
    FitRequest request;
    std::vector<int> iterations;  ///< ascending
    Engineering how;
    bool base_instructions = false;  ///< loops that are compiled twice run as the rest of the program
};

struct ArrivalOptions {
    int every = 16;              ///< of the blocks of 256 texels, one of so many is fitted
    int repetitions = 3;         ///< of every fit, by turns
    uint32_t least_samples = 9;  ///< of a texel that counts: as many as there are unknowns
    double tolerance = 1.01;     ///< a texel has arrived at so many times the least error that any fit left it
};

/// Which share of the texels each climber has brought home after so many iterations, and after what time, on one
/// thread. `samples`: of all texels.
std::vector<rows_of::reflectance::Arrival> texel_arrivals(const Dataset& dataset, const SharedTexels& samples,
                                                          const std::vector<Climber>& climbers,
                                                          const ArrivalOptions& options);

}  // namespace radiafit::harness
