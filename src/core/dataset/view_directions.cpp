#include "dataset/view_directions.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "base/wording.h"
#include "geometry/direction_hull.h"

namespace radiafit {

Vec3d surface_centre(const Mesh& mesh, const Grid& grid) {
    if (grid.width > 0) return grid.origin + 0.5 * ((grid.width - 1) * grid.right + (grid.height - 1) * grid.down);
    Eigen::AlignedBox3d box;
    for (const Vec3f& p : mesh.positions) box.extend(p.cast<double>());
    return box.isEmpty() ? Vec3d::Zero() : Vec3d(box.center());
}

std::vector<double> angles_outside(const Vec3d& centre, std::span<const View> views) {
    std::vector<double> out(views.size(), 0.0);
    const auto add = [&](const auto& direction_of) {
        std::vector<Vec3d> training;
        for (const View& view : views)
            if (!view.held_out) training.push_back(direction_of(view));
        for (size_t i = 0; i < views.size() && !training.empty(); ++i)
            if (views[i].held_out) out[i] = std::max(out[i], angle_outside(training, direction_of(views[i])));
    };
    add([&](const View& view) { return view.direction_to_camera(centre); });
    if (!views.empty() && views[0].light) add([&](const View& view) { return view.light->direction_from(centre); });
    return out;
}

std::string outside_note(std::span<const View> views, std::span<const double> angles) {
    constexpr double degrees = 180 / std::numbers::pi;
    size_t outside = 0, held_out = 0;
    double farthest = 0;
    for (size_t i = 0; i < views.size(); ++i) {
        held_out += views[i].held_out;
        outside += angles[i] >= least_outside;
        farthest = std::max(farthest, angles[i] * degrees);
    }
    if (outside == 0) return {};
    return fmt::format(
        "{} of {} held-out images lie outside the directions that the others span, the farthest by {:.0f} degrees: "
        "what "
        "they measure is extrapolation; {} spread:{} holds out images amid the others",
        outside, held_out, farthest, option_name("holdout"), held_out);
}

}  // namespace radiafit
