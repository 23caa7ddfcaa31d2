#include "fragment/view_order.h"

#include <algorithm>

namespace radiafit {

std::vector<uint32_t> batches_of_neighbours(const Dataset& dataset, const std::vector<uint32_t>& views, int batch) {
    Vec3d centre = Vec3d::Zero(), mean = Vec3d::Zero();
    for (const Vec3f& p : dataset.mesh.positions) centre += p.cast<double>() / double(dataset.mesh.positions.size());
    struct Left {
        uint32_t view;
        Vec3d direction;
        double near;
    };
    std::vector<Left> left;
    for (uint32_t view : views) {
        const Vec3d to_eye = dataset.views[view].camera.center() - centre;
        left.push_back({view, to_eye.stableNormalized(), 0});
        mean += left.back().direction;
    }
    std::vector<uint32_t> order;
    const auto take = [&](const Vec3d& direction, bool farthest) {
        for (Left& l : left) l.near = l.direction.dot(direction) * (farthest ? -1 : 1);
        // The first of equals.
        const auto best =
            std::max_element(left.begin(), left.end(), [](const Left& a, const Left& b) { return a.near < b.near; });
        Vec3d found = best->direction;
        order.push_back(best->view);
        left.erase(best);
        return found;
    };
    while (!left.empty()) {
        const Vec3d seed = take(mean, true);
        for (int i = 1; i < batch && !left.empty(); ++i) take(seed, false);
    }
    return order;
}

}  // namespace radiafit
