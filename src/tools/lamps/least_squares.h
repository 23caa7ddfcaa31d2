#pragma once
#include <Eigen/Core>
#include <utility>

#include "base/decompositions.h"

namespace radiafit::tools {

/// Levenberg-Marquardt (Marquardt 1963) of few unknowns, dense: moves `state` to where residuals(state) are least, by
/// steps of moved(state, step), until a step gains less than 1e-12. jacobian(state, residuals): by the steps' numbers.
/// Returns the residuals there.
template <class State, class Residuals, class Jacobian, class Moved>
Eigen::VectorXd minimize(State& state, const Residuals& residuals, const Jacobian& jacobian, const Moved& moved) {
    constexpr int most_steps = 100;
    constexpr double most_damping = 1e9;
    Eigen::VectorXd now = residuals(state);
    double damping = 1e-4;
    for (int step = 0; step < most_steps; ++step) {
        const Eigen::MatrixXd slope = jacobian(state, now), matrix = slope.transpose() * slope;
        const Eigen::VectorXd gradient = slope.transpose() * now;
        for (;;) {
            Eigen::MatrixXd damped = matrix;
            damped.diagonal() *= 1 + damping;
            State other = moved(state, Eigen::VectorXd(-solve_symmetric(damped, gradient)));
            Eigen::VectorXd after = residuals(other);
            const double gain = now.squaredNorm() - after.squaredNorm();
            if (gain > 0) {
                state = std::move(other);
                now = std::move(after);
                damping /= 10;
                if (gain < 1e-12 * (1 + now.squaredNorm())) return now;
                break;
            }
            if ((damping *= 10) > most_damping) return now;
        }
    }
    return now;
}

}  // namespace radiafit::tools
