#pragma once
#include <initializer_list>

/// What the verbs of optim/engine.h are about: vectors, registers and dot products by number.
namespace radiafit {

/// Vectors of an engine, [N] each. The optimizer's private ones follow, from first_own on.
namespace vector {
enum : int { p, trial, d, g, trial_g, precondition, fresh, first_own, none = -1 };
}

/// Numbers of a problem, as ProblemState (shaders/optimize/problem_state.glsl) lists them. The optimizer's private
/// ones follow, from first_own on, and from first_product on its dot products.
namespace number {
enum : int { error, norm, slope, step_factor, beta, accepted, status, iterations, alpha, taken, first_own };
constexpr int first_product = 64;
}  // namespace number

/// What an optimizer needs in addition to the vectors, numbers and dot products that all have.
struct Room {
    int vectors = 0;   ///< private to the optimizer
    int numbers = 0;   ///< private to the optimizer, of each problem; 8 at most
    int products = 0;  ///< dot products beyond PRODUCT_NORM, PRODUCT_CROSS and PRODUCT_CONJUGATE

    int vector_count() const { return vector::first_own + vectors; }
    int product_count() const { return 3 + products; }
    bool operator==(const Room&) const = default;
};

/// Per problem: (a / weight) . b, or a . b without a weight.
struct DotProduct {
    int a, b, weight, into;  ///< vectors, and the number of the product
};

}  // namespace radiafit
