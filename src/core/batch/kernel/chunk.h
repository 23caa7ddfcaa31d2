#pragma once
// What passes between the library and a model that was compiled for itself: plain numbers and pointers.
namespace radiafit::batch {

enum class BatchLoss : int { square, huber, cauchy };

enum class BatchOptimizer : int { levenberg_marquardt, conjugate_gradients, lbfgs, adam };

/// How a problem ended.
enum class BatchStatus : int {
    converged,        ///< at a minimum, which the samples determine
    at_bound,         ///< the same, with a parameter at a bound
    max_iterations,   ///< took as many as were allowed
    stalled,          ///< no step lowers the error, yet its gradient is not zero
    underdetermined,  ///< at a minimum, but the samples don't determine all parameters
    no_samples,
    not_finite,  ///< the error of the start, or its derivatives, are not finite
    count
};

/// Some problems of a batch. `real`: float or double, as the model was compiled; null pointers where said.
struct Chunk {
    long long first, count;    ///< problems
    const long long* offsets;  ///< [all problems + 1] where each one's samples begin; null: each has as many
    long long samples;         ///< of each, without offsets
    const void* terms;         ///< real [all samples][terms], or [samples][terms] where problems share them
    bool shared_terms;
    const void* targets;         ///< real [all samples][values]; not a number: a sample that is missing
    const void* weights;         ///< real [all samples], 1 / variance; null: 1
    const void* starts;          ///< real [starts][all problems, or 1][parameters]
    long long start_count;       ///< of each problem
    long long starts_of_each;    ///< all problems, or 1: each starts from the same
    const void *lower, *upper;   ///< real [parameters]
    const unsigned char* fixed;  ///< [parameters] 1: stays as it starts
    BatchOptimizer optimizer;
    double learning_rate;  ///< of Adam: its first step of a parameter, in the unit of batch/kernel/first_order.h
    int iterations;
    double tolerance;  ///< of a parameter, in standard deviations
    BatchLoss loss;
    double loss_scale;
    bool known_noise;  ///< weights are 1 / variance, rather than relative to it
    // Out, of all problems. A parameter that is fixed or at a bound has no deviation.
    void* parameters;     ///< real [problems][parameters]
    void* deviations;     ///< real [problems][parameters]
    void* covariance;     ///< real [problems][parameters][parameters]; null: not wanted
    void* error;          ///< real [problems] sum of w r^2, or of the loss
    int *status, *steps;  ///< [problems]
    long long* seen;      ///< [problems] samples that are not missing
};

}  // namespace radiafit::batch
