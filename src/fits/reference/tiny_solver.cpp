#include "reference/tiny_solver.h"

#include <ceres/tiny_solver.h>

#include <algorithm>

namespace radiafit::fits {
namespace {

template <class Number, int parameters>
class OfSize final : public TinySolver<Number> {
    /// As ceres::TinySolver asks for it.
    struct Function {
        using Scalar = Number;
        enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = parameters };
        const TinyProblem<Number>* problem;
        int count;

        int NumResiduals() const { return problem->residuals; }
        int NumParameters() const { return count; }
        bool operator()(const Number* x, Number* residuals, Number* jacobian) const {
            problem->evaluate(problem->of, x, residuals, jacobian);
            return true;
        }
    };

public:
    explicit OfSize(int count) : count_(count) {}

    TinyEnd<Number> solve(const TinyProblem<Number>& problem, const TinyOptions<Number>& options, Number* x) override {
        solver_.options.max_num_iterations = options.iterations;
        solver_.options.gradient_tolerance = options.gradient_tolerance;
        solver_.options.parameter_tolerance = options.step_tolerance;
        solver_.options.function_tolerance = options.cost_tolerance;
        solver_.options.cost_threshold = 0;
        solver_.options.initial_trust_region_radius = options.initial_radius;
        at_ = Eigen::Map<const Eigen::Matrix<Number, parameters, 1>>(x, count_);
        const auto& summary = solver_.Solve(Function{&problem, count_}, &at_);
        std::copy_n(at_.data(), count_, x);
        return {summary.final_cost, summary.iterations,
                summary.status == ceres::TinySolver<Function>::HIT_MAX_ITERATIONS};
    }

private:
    int count_;
    ceres::TinySolver<Function> solver_;
    Eigen::Matrix<Number, parameters, 1> at_;
};

}  // namespace

template <class Scalar>
std::unique_ptr<TinySolver<Scalar>> tiny_solver(int parameters) {
    switch (parameters) {
        case 3:
            return std::make_unique<OfSize<Scalar, 3>>(parameters);
        case 9:
            return std::make_unique<OfSize<Scalar, 9>>(parameters);
        default:
            if constexpr (sizeof(Scalar) == sizeof(double)) {  // curves
                if (parameters == 5) return std::make_unique<OfSize<Scalar, 5>>(parameters);
                if (parameters == 6) return std::make_unique<OfSize<Scalar, 6>>(parameters);
            }
            return std::make_unique<OfSize<Scalar, Eigen::Dynamic>>(parameters);
    }
}

template std::unique_ptr<TinySolver<float>> tiny_solver(int);
template std::unique_ptr<TinySolver<double>> tiny_solver(int);

}  // namespace radiafit::fits
