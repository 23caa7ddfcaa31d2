#include "fitting/tune_candidate.h"

namespace radiafit::fits {

std::vector<Ladder> loss_ladders() {
    return {{"loss", {"square", "huber", "cauchy"}},
            {"loss_scale", {"0.02", "0.05", "0.1", "0.2"}, [](const FitRequest& request) {
                 return request.model.loss.robust();
             }}};
}

}  // namespace radiafit::fits
