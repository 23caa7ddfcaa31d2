#include "optim/methods.h"  // first, as it includes this file at its end
#ifndef RADIAFIT_OPTIM_LBFGS_H
#define RADIAFIT_OPTIM_LBFGS_H
namespace radiafit {

/// Limited-memory BFGS (Nocedal and Wright, Numerical Optimization, Algorithm 7.4), for each problem by itself, with
/// the diagonal preconditioner of conjugate gradients as the first Hessian and their line search: the exact step along
/// d. A rejected trial leaves an empty pair, and the next direction is the steepest.
class Lbfgs {
public:
    explicit Lbfgs(const OptimizerOptions& options) : options_(options) {}
    Room room() const { return {2 * options_.history, options_.history, options_.history + 2}; }

    template <class E>
    void judge(E& e, int k) const {
        using namespace vector;
        const bool refresh = options_.fresh(k);
        const int slot = k % options_.history, weight = refresh ? fresh : precondition;
        e.gradient_pass(refresh);
        e.dot({{trial_g, trial_g, weight, PRODUCT_NORM}});
        e.step(Step::judge_trial, turn(true, slot));  // leaves the direction to what follows
        e.update(Update::lbfgs_keep, {p, g, precondition, s(slot), y(slot), trial, trial_g, fresh}, {number::accepted},
                 {float(refresh)});
        e.dot({{s(slot), y(slot), none, along}});
        e.step(Step::lbfgs_pair, turn(refresh, slot));

        e.update(Update::lbfgs_begin, {d, g}, {}, {});
        const int pairs = std::min(k, options_.history);  // the first trial makes none
        for (int age = 0; age < pairs; ++age) {
            const int i = (k - age) % options_.history;
            e.dot({{s(i), d, none, projection(i)}});
            e.update(Update::lbfgs_subtract, {d, y(i)}, {rho(i), number::first_product + projection(i)}, {});
        }
        e.update(Update::lbfgs_scale, {d, precondition}, {}, {});
        for (int age = pairs - 1; age >= 0; --age) {
            const int i = (k - age) % options_.history;
            e.dot({{y(i), d, none, back}});
            e.update(Update::lbfgs_add, {d, s(i)},
                     {rho(i), number::first_product + projection(i), number::first_product + back}, {});
        }
        e.dot({{d, g, none, along}});
        e.step(Step::lbfgs_slope, turn(refresh, slot));
        e.update(Update::lbfgs_choose, {d, g, precondition}, {number::beta}, {});
    }

    template <class E>
    void move(E& e, int) const {
        e.directional_pass();
        e.step(Step::step_length, turn(false, 0));
        e.update(Update::advance, {vector::trial, vector::p, vector::d}, {number::taken}, {});
    }

private:
    static constexpr int along = PRODUCT_CONJUGATE + 1, back = along + 1;
    static int projection(int slot) { return back + 1 + slot; }
    static int rho(int slot) { return number::first_own + slot; }
    static int s(int slot) { return vector::first_own + slot; }
    int y(int slot) const { return vector::first_own + options_.history + slot; }
    Turn turn(bool restart, int slot) const { return {RULE_CG_MODERN, restart, slot, options_.stop(), 0, 0}; }
    OptimizerOptions options_;
};

}  // namespace radiafit
#endif
