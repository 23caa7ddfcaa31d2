#include "optim/methods.h"  // first, as it includes this file at its end
#ifndef RADIAFIT_OPTIM_ADAM_H
#define RADIAFIT_OPTIM_ADAM_H
#include <cmath>

namespace radiafit {

/// Adam (Kingma and Ba, 2015) with a constant learning rate, and without a line search. The trial wanders; p is the
/// best point that it came by.
class Adam {
public:
    explicit Adam(const OptimizerOptions& options) : options_(options) {}
    Room room() const { return {.vectors = 2}; }

    template <class E>
    void judge(E& e, int) const {
        e.gradient_pass(false);
        e.dot({{vector::trial_g, vector::trial_g, vector::none, PRODUCT_NORM}});
        e.step(Step::adam_judge, {0, 0, 0, options_.stop(), 0, 0});
        e.update(Update::adam_keep, {vector::p, vector::trial}, {number::accepted}, {});
    }

    template <class E>
    void move(E& e, int k) const {
        constexpr double first = 0.9, second = 0.999;  // decay of the means of the gradient and of its square
        e.update(Update::adam_move, {vector::trial, mean, square, vector::trial_g}, {number::taken},
                 {float(first), float(second), float(options_.learning_rate / (1 - std::pow(first, k + 1))),
                  float(1 / (1 - std::pow(second, k + 1)))});
    }

private:
    static constexpr int mean = vector::first_own, square = mean + 1;
    OptimizerOptions options_;
};

}  // namespace radiafit
#endif
