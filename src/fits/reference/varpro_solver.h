#pragma once
#include "reference/vertex_runs.h"

namespace radiafit::fits {

/// Variable projection: surface maps follow the view map in closed form, and damped Newton steps with the exact Hessian
/// of what is left minimize over the view map (Golub and Pereyra 1973). Needs penalties that are sums of squares.
struct VarproOptions {
    int iterations = 25;        ///< trials of the view map; the first row is the start, the second the projection of it
    double stop_residual = 0;   ///< root mean square residual; 0 = off
    double stop_change = 1e-7;  ///< relative decrease of E_t by an accepted step; the 32-bit Hessian shows little below
};

/// Throws UserError for the paper's bounds penalty, and for more than 1024 view parameters.
VertexSolver varpro_solver(const LfmOptions& model, const VarproOptions& options);

}  // namespace radiafit::fits
