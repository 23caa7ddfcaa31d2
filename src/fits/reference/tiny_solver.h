#pragma once
#include <memory>

#include "base/rings.h"

/// ceres::TinySolver, compiled once for what all who compare with it solve.
namespace radiafit::fits {

template <class Scalar>
struct TinyProblem {
    int residuals;
    const void* of;
    /// At x [parameters]: the residuals and, unless null, their derivatives [parameters][residuals].
    void (*evaluate)(const void* of, const Scalar* x, Scalar* residuals, Scalar* jacobian);
};

/// Its own, none of which ends a solution unless it is set.
template <class Scalar>
struct TinyOptions {
    int iterations = 50;
    Scalar gradient_tolerance = 0, step_tolerance = 0, cost_tolerance = 0;
    Scalar initial_radius = 1e4;
};

template <class Scalar>
struct TinyEnd {
    Scalar cost;  ///< half the sum of squared residuals
    int iterations;
    bool spent;  ///< it took as many iterations as it may
};

template <class Scalar>
class TinySolver {
public:
    virtual ~TinySolver() = default;
    /// From x [parameters] to the end, which replaces it. Memory is used again by the next problem.
    virtual TinyEnd<Scalar> solve(const TinyProblem<Scalar>& problem, const TinyOptions<Scalar>& options,
                                  Scalar* x) = 0;
};

/// Scalar: float or double. For 3 and 9 parameters, in doubles for 5 and 6, too, their number is known when it is
/// compiled, which is fastest.
template <class Scalar>
std::unique_ptr<TinySolver<Scalar>> tiny_solver(int parameters);

}  // namespace radiafit::fits
