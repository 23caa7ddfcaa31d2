#include <algorithm>
#include <vector>

#include "reference/curve_rivals.h"
#include "reference/tiny_solver.h"

namespace radiafit::fits {
namespace {

class CurveByTinySolver final : public TinyCurveSolver {
public:
    CurveByTinySolver(int parameters, const TinyCurveOptions& options)
        : parameters_(size_t(parameters)), at_(parameters_), solver_(tiny_solver<double>(parameters)) {
        options_.iterations = options.iterations;
        options_.step_tolerance = options.step;
    }
    void solve(int residuals, double* p, const void* of,
               void (*evaluate)(const void*, const double*, double*, double*)) override {
        residual_.resize(size_t(residuals));
        rows_.resize(size_t(residuals) * parameters_);
        of_ = of;
        evaluate_ = evaluate;
        known_ = false;
        solver_->solve({residuals, this,
                        [](const void* self, const double* x, double* r, double* jacobian) {
                            static_cast<CurveByTinySolver*>(const_cast<void*>(self))->look(x, r, jacobian);
                        }},
                       options_, p);
    }

private:
    // TinySolver asks for residuals first, and for derivatives again at the same place: both are computed once.
    void look(const double* x, double* r, double* jacobian) {
        if (!known_ || !std::equal(x, x + parameters_, at_.begin())) {
            evaluate_(of_, x, residual_.data(), rows_.data());
            std::copy_n(x, parameters_, at_.begin());
            known_ = true;
        }
        std::ranges::copy(residual_, r);
        for (size_t i = 0; jacobian && i < parameters_; ++i)
            for (size_t s = 0; s < residual_.size(); ++s)
                jacobian[i * residual_.size() + s] = rows_[s * parameters_ + i];
    }

    size_t parameters_;
    TinyOptions<double> options_;
    bool known_ = false;  ///< what follows, at `at_`
    std::vector<double> at_, residual_, rows_;
    const void* of_ = nullptr;
    void (*evaluate_)(const void*, const double*, double*, double*) = nullptr;
    std::unique_ptr<TinySolver<double>> solver_;
};

}  // namespace

std::unique_ptr<TinyCurveSolver> tiny_curve_solver(int parameters, const TinyCurveOptions& options) {
    return std::make_unique<CurveByTinySolver>(parameters, options);
}

}  // namespace radiafit::fits
