#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/rings.h"

/// Other people's solvers of one small nonlinear least-squares problem, all by the same residuals and derivatives.
namespace radiafit::fits {

struct CurveProblem {
    int residuals, parameters;
    std::vector<double> start;  ///< [parameters]
    /// Residuals r [residuals] at p [parameters], and their derivatives [residuals][parameters]; either may be null.
    std::function<void(const double* p, double* r, double* derivatives)> evaluate;
};

struct CurveEnd {
    std::vector<double> parameters;
    bool converged = false;  ///< by what the solver says itself
    int iterations = 0;      ///< or evaluations, where that is all it counts
};

struct CurveRival {
    std::string name, setting;
    std::function<CurveEnd(const CurveProblem& problem, int iterations)> solve;
};

/// Ceres in three settings, its TinySolver, GSL's multifit_nlinear, Eigen's LevenbergMarquardt (a port of MINPACK), and
/// NLopt, each as exact as its tolerances can be set.
const std::vector<CurveRival>& curve_rivals();

/// TinySolver for one problem after another of a size that is known when it is compiled, as it is fastest.
class TinyCurveSolver {
public:
    virtual ~TinyCurveSolver() = default;
    /// From p [parameters] to the end, which replaces it. evaluate(of, ...) as CurveProblem::evaluate.
    virtual void solve(int residuals, double* p, const void* of,
                       void (*evaluate)(const void* of, const double* p, double* r, double* derivatives)) = 0;
};
struct TinyCurveOptions {
    int iterations = 100;
    double step = 1e-8;  ///< ends where a step is shorter than so much of the parameters
};
/// parameters: 3, 5, 6 or 9.
std::unique_ptr<TinyCurveSolver> tiny_curve_solver(int parameters, const TinyCurveOptions& options);

}  // namespace radiafit::fits
