#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "base/lanes.h"
#include "model/prelude.h"
#include "model/status.h"
#include "optim/verbs.h"

/// The list of optimizers. One consists of a schedule, which is a header that is included at the end, and of texts in
/// shaders/optimize that GLSL and C++ share: steps, which decide for one problem between two passes, and updates, which
/// change an element of vectors. All of them are named here and nowhere else.
namespace radiafit {

/// X(file, function)
#define RADIAFIT_STEPS(X)       \
    X(judge_trial, judge_trial) \
    X(step_length, step_length) \
    X(lbfgs, lbfgs_pair)        \
    X(lbfgs, lbfgs_slope)       \
    X(adam, adam_judge)

/// X(file, function, vectors it takes, how many of them it writes, numbers of the problem, and dot products behind
/// them)
#define RADIAFIT_UPDATES(X)                           \
    X(update_direction, update_direction, 7, 4, 2, 0) \
    X(advance, advance, 3, 1, 1, 0)                   \
    X(lbfgs, lbfgs_keep, 8, 5, 1, 0)                  \
    X(lbfgs, lbfgs_begin, 2, 1, 0, 0)                 \
    X(lbfgs, lbfgs_subtract, 2, 1, 1, 1)              \
    X(lbfgs, lbfgs_scale, 2, 1, 0, 0)                 \
    X(lbfgs, lbfgs_add, 2, 1, 1, 2)                   \
    X(lbfgs, lbfgs_choose, 3, 1, 1, 0)                \
    X(adam, adam_keep, 2, 1, 1, 0)                    \
    X(adam, adam_move, 4, 3, 1, 0)

namespace shared_text {
using std::abs, std::acos, std::cos, std::exp, std::log, std::max, std::min, std::sqrt, radiafit::sqrt;

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"

/// An element is `V`: problems side by side in lanes of `real`, or real itself.
template <class real_type, class V>
struct Optimize {
    using real = real_type;
    using element = V;
    static element where(const element& condition, const element& a, const element& b) {
        return select_nonzero(condition, a, b);
    }
#include "optimize/problem_state.glsl"
//
#include "optimize/elements.glsl"
//
#include "optimize/judge_trial.glsl"
//
#include "optimize/step_length.glsl"
//
#include "optimize/update_direction.glsl"
//
#include "optimize/advance.glsl"
//
#include "optimize/lbfgs.glsl"
//
#include "optimize/adam.glsl"
};

#pragma GCC diagnostic pop

}  // namespace shared_text

template <class real, class V = real>
using ProblemText = shared_text::Optimize<real, V>;
using StopRules = ProblemText<float>::StopRules;
using Turn = ProblemText<float>::Turn;

#define RADIAFIT_NAME(file, function, ...) function,
enum class Step { RADIAFIT_STEPS(RADIAFIT_NAME) };
enum class Update { RADIAFIT_UPDATES(RADIAFIT_NAME) };
#undef RADIAFIT_NAME

struct StepName {
    const char *file, *function;
};
struct UpdateShape {
    const char *file, *function;
    int vectors, written, numbers, products;
};
/// Files and functions of the steps, indexed by Step; below, those of the updates, by Update.
inline constexpr StepName steps[] = {
#define RADIAFIT_ROW(file, function) {#file, #function},
    RADIAFIT_STEPS(RADIAFIT_ROW)
#undef RADIAFIT_ROW
};
inline constexpr UpdateShape updates[] = {
#define RADIAFIT_ROW(file, function, ...) {#file, #function, __VA_ARGS__},
    RADIAFIT_UPDATES(RADIAFIT_ROW)
#undef RADIAFIT_ROW
};
/// Vectors, by the update that writes most.
inline constexpr int most_written = std::ranges::max(updates, {}, &UpdateShape::written).written;

enum class Rule {
    steepest_descent = RULE_STEEPEST_DESCENT,
    cg_paper = RULE_CG_PAPER,
    cg_modern = RULE_CG_MODERN,
    lbfgs,
    adam
};

/// What a person calls an optimizer, which rule it is in each of a fit's modes, and which options it takes.
struct Method {
    const char* name;
    const char* help;
    Rule paper, modern;
    const char* only_mode = "modern";  ///< of the fit where both rules are one: what experiments compare it in
    bool lines = true;                 ///< measures every iteration's step along its direction
    bool stop_output_change = true;    ///< takes the options of these names
    bool history = false, learning_rate = false;
};
inline constexpr Method methods[] = {
    {.name = "cg", .help = "conjugate gradients", .paper = Rule::cg_paper, .modern = Rule::cg_modern},
    {.name = "sd",
     .help = "steepest descent",
     .paper = Rule::steepest_descent,
     .modern = Rule::steepest_descent,
     .only_mode = "paper",
     .lines = false},
    {.name = "lbfgs", .help = "limited-memory BFGS", .paper = Rule::lbfgs, .modern = Rule::lbfgs, .history = true},
    {.name = "adam",
     .help = "Adam, which keeps the best point that it comes by",
     .paper = Rule::adam,
     .modern = Rule::adam,
     .lines = false,
     .stop_output_change = false,
     .learning_rate = true},
};

/// A method in a mode: one that is the same in both has no name of a mode.
struct NamedRule {
    const Method* method;
    const char* mode;
    Rule rule;
    std::string name;  ///< "cg modern", "sd"
};
inline std::vector<NamedRule> named_rules() {
    std::vector<NamedRule> rules;
    for (const Method& m : methods) {
        const std::string name = m.name;
        const bool one = m.paper == m.modern;
        rules.push_back({&m, one ? m.only_mode : "modern", m.modern, one ? name : name + " modern"});
        if (!one) rules.push_back({&m, "paper", m.paper, name + " paper"});
    }
    return rules;
}
inline std::vector<Rule> all_rules() {
    std::vector<Rule> rules;
    for (const NamedRule& named : named_rules()) rules.push_back(named.rule);
    return rules;
}

struct OptimizerOptions {
    Rule rule = Rule::cg_modern;
    int iterations = 25;           ///< Section 5.3.2 rule 3
    float stop_residual = 0;       ///< rule 1: root mean square residual, units of the targets; 0 = off
    float stop_output_change = 0;  ///< rule 2: root mean square change of the model's output; 0 = off
    /// Iterations between fresh preconditioners. Each restarts, and hard problems need long runs of conjugate
    /// directions: 10 takes the median vertex of the star four times as long to 1.01 of the least error.
    int refresh_every = 100;
    int first_refresh = 10;       ///< and once early: a map that starts at zero gives its partner no curvature before
    int history = 5;              ///< pairs that lbfgs keeps, 8 at most
    float learning_rate = 0.02f;  ///< of adam: the first step, in units of the parameters
    // For conjugate gradients and steepest descent, in experiments on what corrections of the paper's text are worth.
    int left_out = 0;      ///< corrections left out: WITHOUT_* of shaders/optimize/problem_state.glsl
    float first_step = 1;  ///< of steepest descent with WITHOUT_MEASURED_STEP

    bool fresh(int iteration) const { return iteration % refresh_every == 0 || iteration == first_refresh; }
    StopRules stop() const { return {stop_residual, stop_output_change}; }
};

}  // namespace radiafit

#include "optim/adam.h"
#include "optim/conjugate_gradients.h"
#include "optim/lbfgs.h"

namespace radiafit {

/// body(schedule) with the one that options.rule names. A schedule judges the trial, and moves on to the next:
/// judge(engine, iteration), move(engine, iteration); and says the Room that it needs.
template <class Body>
auto with_schedule(const OptimizerOptions& options, const Body& body) {
    switch (options.rule) {
        case Rule::lbfgs:
            return body(Lbfgs(options));
        case Rule::adam:
            return body(Adam(options));
        default:
            return body(ConjugateGradients(options));
    }
}
inline Room room_of(const OptimizerOptions& options) {
    return with_schedule(options, [](const auto& schedule) { return schedule.room(); });
}

}  // namespace radiafit
