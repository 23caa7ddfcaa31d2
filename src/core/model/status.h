#pragma once
#include <cstdint>
#include <string>

namespace radiafit {

/// How a problem ended; the values of STATUS_* in shaders/optimize/problem_state.glsl.
enum class Status : uint8_t {
    active,
    residual,       ///< root mean square residual below its threshold
    output_change,  ///< change of the model's output below its threshold
    stationary,     ///< no step lowers the error any more
    max_iterations,
    no_samples,
    not_finite,       ///< the error of the start, or a sample, is not finite
    underdetermined,  ///< at an optimum, but the samples don't determine all parameters
    count
};
std::string to_string(Status status);  ///< as the key in fit.json, such as "max_iterations"
const char* meaning(Status status);    ///< in a few words, for people

}  // namespace radiafit
