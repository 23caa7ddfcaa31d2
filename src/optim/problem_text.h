#pragma once
#include "model/prelude.h"
#include "model/status.h"

/// shaders/optimize/*.glsl as C++: what happens to one problem between two passes.
namespace radiafit {
namespace shared_text {
using std::abs, std::acos, std::cos, std::exp, std::log, std::max, std::min, std::sqrt;

template <class real_type>
struct Optimize {
    using real = real_type;
#include "optimize/problem_state.glsl"
//
#include "optimize/after_direction.glsl"
//
#include "optimize/after_line.glsl"
};
}  // namespace shared_text

template <class real>
using ProblemText = shared_text::Optimize<real>;

/// The update rules of the texts.
enum class Rule { steepest_descent = RULE_STEEPEST_DESCENT, cg_paper = RULE_CG_PAPER, cg_modern = RULE_CG_MODERN };

}  // namespace radiafit
