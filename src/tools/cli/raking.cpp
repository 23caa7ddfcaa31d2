#include "cli/raking.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/log.h"
#include "cli/frames.h"
#include "cli/shown_fit.h"
#include "dataset/view_directions.h"
#include "geometry/direction_hull.h"

namespace radiafit::tools {
namespace {

constexpr double radians = std::numbers::pi / 180;

/// Unit directions of the picture in world space.
struct PictureAxes {
    Vec3d right, up, outward;
};

PictureAxes axes_of(const Dataset& dataset, const View& shown) {
    if (dataset.has_grid()) {
        const Grid& grid = dataset.grid;
        return {grid.right.normalized(), -grid.down.normalized(), grid.normal()};
    }
    const Mat3d& camera = shown.camera.cam_from_world_rotation;
    return {camera.row(0), -camera.row(1), -camera.row(2)};
}

/// The lamp's direction, clockwise from the top of the picture.
Vec3d raking_direction(const PictureAxes& axes, double degrees, double elevation) {
    const double around = degrees * radians, above = elevation * radians;
    return std::cos(above) * (std::sin(around) * axes.right + std::cos(around) * axes.up) +
           std::sin(above) * axes.outward;
}

std::string name_of_side(double degrees) {
    constexpr std::array sides = {"top",    "top_right",   "right", "bottom_right",
                                  "bottom", "bottom_left", "left",  "top_left"};
    return fmt::format("raking_{:03.0f}_{}", degrees, sides[size_t(std::lround(degrees / 45)) % sides.size()]);
}

/// In degrees, of every frame; 0 amid the lamps that were fitted.
std::vector<double> beyond_fitted(const std::vector<NamedView>& frames, Fitted& fitted) {
    const Dataset& dataset = fitted.dataset();
    const Vec3d centre = surface_centre(dataset.mesh, dataset.grid);
    std::vector<Vec3d> lamps;
    for (const uint32_t v : fitted_views(dataset, fitted.record()))
        lamps.push_back(dataset.views[v].light->direction_from(centre));
    std::vector<double> out;
    for (const NamedView& frame : frames) out.push_back(angle_outside(lamps, frame.view.light->place) / radians);
    return out;
}

}  // namespace

void render_raking(const RenderOptions& o, Fitted& fitted, const View& shown) {
    const Dataset& dataset = fitted.dataset();
    const PictureAxes axes = axes_of(dataset, shown);
    const int directions = o.directions.value_or(8);
    std::vector<NamedView> frames;
    for (int i = 0; i < directions; ++i) {
        const double degrees = 360.0 * i / directions;
        frames.push_back({name_of_side(degrees), o.framed(shown, dataset)});
        frames.back().view.light = {Light::Kind::distant, raking_direction(axes, degrees, *o.raking), Vec3d::Ones()};
    }
    const double least_share = render_frames(o, shown_fit(o, fitted), dataset, frames, "raking light");
    const std::vector<double> beyond = beyond_fitted(frames, fitted);
    const auto outside = std::ranges::count_if(beyond, [](double angle) { return angle * radians >= least_outside; });
    if (outside > 0)
        log_warning(
            fmt::format("{} of {} lamps lie beyond those that were fitted, by up to {:.0f} degrees: there the model "
                        "guesses{}",
                        outside, frames.size(), std::ranges::max(beyond),
                        least_share < 1 ? "; farthest out " + share_in_words(fitted, least_share) : ""));
}

}  // namespace radiafit::tools
