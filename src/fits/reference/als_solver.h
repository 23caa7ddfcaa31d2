#pragma once
#include "reference/vertex_runs.h"

namespace radiafit::fits {

struct AlsOptions {
    int iterations = 25;         ///< of both half steps
    double stop_residual = 0;    ///< root mean square residual; 0 = off
    double stop_change = 1e-12;  ///< stop where E_t falls by less than this share
};

/// Alternating least squares on E_t: all surface maps given the view map, then the view map given the surface maps,
/// each half step the exact minimum over all K terms at once: one banded system per map and channel; the three channels
/// go side by side, in lanes.
/// Parameters that no sample and no smoothness holds stay where they are. Bounds (modern penalty) are part of the half
/// step: the set of parameters beyond them is guessed from the last one, and the step repeated until the guess holds.
/// Throws UserError for the paper's penalty, which isn't convex where a half step needs it.
VertexSolver als_solver(const LfmOptions& model, const AlsOptions& options);

}  // namespace radiafit::fits
