#include <ceres/tiny_solver.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "reference/curve_rivals.h"

namespace radiafit::fits {
namespace {

template <int parameters>
class TinyOfSize final : public TinyCurveSolver {
public:
    explicit TinyOfSize(const TinyCurveOptions& options) {
        solver_.options.max_num_iterations = options.iterations;
        solver_.options.parameter_tolerance = options.step;
        solver_.options.gradient_tolerance = solver_.options.function_tolerance = 0;
        solver_.options.cost_threshold = 0;
    }
    void solve(int residuals, double* p, const void* of,
               void (*evaluate)(const void*, const double*, double*, double*)) override {
        function_.residuals = residuals;
        function_.of = of;
        function_.evaluate = evaluate;
        function_.known = false;
        function_.rows.resize(residuals, parameters);
        Eigen::Matrix<double, parameters, 1> x;
        std::copy_n(p, parameters, x.data());
        solver_.Solve(function_, &x);
        std::copy_n(x.data(), parameters, p);
    }

private:
    struct Function {
        using Scalar = double;
        enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = parameters };
        int residuals = 0;
        mutable bool known = false;  ///< what follows, at `at`
        mutable double at[parameters];
        mutable std::vector<double> residual;
        const void* of = nullptr;
        void (*evaluate)(const void*, const double*, double*, double*) = nullptr;
        mutable Eigen::Matrix<double, Eigen::Dynamic, parameters, parameters == 1 ? Eigen::ColMajor : Eigen::RowMajor>
            rows;

        int NumResiduals() const { return residuals; }
        // It asks for residuals first, and for derivatives again at the same place: both are computed once.
        bool operator()(const double* p, double* r, double* jacobian) const {
            if (!known || !std::equal(p, p + parameters, at)) {
                residual.resize(size_t(residuals));
                evaluate(of, p, residual.data(), rows.data());
                std::copy_n(p, parameters, at);
                known = true;
            }
            std::ranges::copy(residual, r);
            if (jacobian)
                Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, parameters>>(jacobian, residuals, parameters) = rows;
            return true;
        }
    };
    Function function_;
    ceres::TinySolver<Function> solver_;
};

}  // namespace

std::unique_ptr<TinyCurveSolver> tiny_curve_solver(int parameters, const TinyCurveOptions& options) {
    switch (parameters) {
        case 3:
            return std::make_unique<TinyOfSize<3>>(options);
        case 5:
            return std::make_unique<TinyOfSize<5>>(options);
        case 6:
            return std::make_unique<TinyOfSize<6>>(options);
        case 9:
            return std::make_unique<TinyOfSize<9>>(options);
        default:
            throw std::logic_error("tiny_curve_solver: compiled for 3, 5, 6 or 9 parameters");
    }
}

}  // namespace radiafit::fits
