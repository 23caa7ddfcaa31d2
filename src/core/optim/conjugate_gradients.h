#include "optim/methods.h"  // first, as it includes this file at its end
#ifndef RADIAFIT_OPTIM_CONJUGATE_GRADIENTS_H
#define RADIAFIT_OPTIM_CONJUGATE_GRADIENTS_H
namespace radiafit {

/// Steepest descent and conjugate gradients with an explicit d'Hd (Section 3). Descent measures its step once, and
/// halves it when the error rises.
class ConjugateGradients {
public:
    explicit ConjugateGradients(const OptimizerOptions& options) : options_(options) {}
    Room room() const { return {}; }

    template <class E>
    void judge(E& e, int k) const {
        using namespace vector;
        const bool modern = options_.rule == Rule::cg_modern, refresh = modern && options_.fresh(k);
        const int weight = !modern ? int(none) : refresh ? int(fresh) : int(precondition);
        e.gradient_pass(refresh);
        e.dot({{trial_g, trial_g, weight, PRODUCT_NORM},
               {trial_g, g, weight, PRODUCT_CROSS},
               {trial_g, d, none, PRODUCT_CONJUGATE}});
        e.step(Step::judge_trial, turn(refresh));
        e.update(Update::update_direction, {p, g, precondition, d, trial, trial_g, fresh},
                 {number::accepted, number::beta}, {float(modern), float(refresh)});
    }

    template <class E>
    void move(E& e, int k) const {
        if (options_.rule != Rule::steepest_descent || k == 0) {
            e.directional_pass();
            e.step(Step::step_length, turn(false));
        }
        e.update(Update::advance, {vector::trial, vector::p, vector::d}, {number::taken}, {});
    }

private:
    Turn turn(bool restart) const {
        return {int(options_.rule), restart, 0, options_.stop(), options_.left_out, options_.first_step};
    }
    OptimizerOptions options_;
};

}  // namespace radiafit
#endif
