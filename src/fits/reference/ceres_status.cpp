#include "reference/ceres_status.h"

#include <ceres/types.h>
#include <glog/logging.h>

namespace radiafit::fits {

void silence_ceres() {
    static const int once = FLAGS_minloglevel = google::GLOG_FATAL;  // by the first of several threads
    static_cast<void>(once);
}

Status ceres_status(int termination, Status failed) {
    switch (termination) {
        case ceres::CONVERGENCE:
            return Status::stationary;
        case ceres::NO_CONVERGENCE:
            return Status::max_iterations;
        case ceres::USER_SUCCESS:
            return Status::residual;
        default:
            return failed;
    }
}

}  // namespace radiafit::fits
