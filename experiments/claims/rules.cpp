#include "rules.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace radiafit::harness {

const std::vector<Claim>& claims() {
    static const std::vector<Claim> all = [] {
        std::vector<Claim> found;
        for (const auto topic :
             {convergence_claims(), images_claims(), time_claims(), utilization_claims(), scale_claims()})
            found.insert(found.end(), topic.begin(), topic.end());
        std::ranges::sort(found, {}, [](const Claim& claim) { return std::atoi(claim.id + 1); });
        return found;
    }();
    return all;
}

}  // namespace radiafit::harness
