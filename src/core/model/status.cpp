#include "model/status.h"

namespace radiafit {

std::string to_string(Status status) {
    static const char* names[] = {"active",         "residual",   "output_change", "stationary",
                                  "max_iterations", "no_samples", "not_finite",    "underdetermined"};
    return names[size_t(status)];
}

const char* meaning(Status status) {
    static const char* meanings[] = {"still running",
                                     "residual below its threshold",
                                     "output hardly changes any more",
                                     "no step lowers the error any more",
                                     "ran all iterations that were asked for",
                                     "no training view shows them",
                                     "a start or a sample is not finite",
                                     "at an optimum, but the samples leave some parameters open"};
    return meanings[size_t(status)];
}

}  // namespace radiafit
