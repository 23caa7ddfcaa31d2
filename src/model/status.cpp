#include "model/status.h"

namespace radiafit {

std::string to_string(Status status) {
    static const char* names[] = {"active",         "residual",   "output_change", "stationary",
                                  "max_iterations", "no_samples", "not_finite",    "underdetermined"};
    return names[size_t(status)];
}

}  // namespace radiafit
