#include "cli/turntable.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "base/error.h"
#include "base/log.h"
#include "cli/frames.h"
#include "cli/shown_fit.h"
#include "dataset/view_directions.h"
#include "eval/turntable.h"

namespace radiafit::tools {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

/// What moves along a path, and what messages call it.
struct Revolution {
    std::vector<View> frames;
    ClosedPath path;
    const char* what;
};

std::vector<View> training_views(const Dataset& dataset) {
    std::vector<View> views;
    for (const uint32_t v : dataset.split(false)) views.push_back(dataset.views[v]);
    return views;
}

Revolution turn_of_camera(const Dataset& dataset, const RenderOptions& o, const View& shown) {
    const std::vector<View> training = training_views(dataset);
    const Vec3d centre = surface_centre(dataset.mesh, dataset.grid), up = up_of(training);
    std::vector<Vec3d> places;
    for (const View& view : training) places.push_back(view.camera.center() - centre);
    Revolution turn{{}, closed_path(places, up, o.turntable, o.full_circle), "photograph"};
    const Camera like = photograph_camera(shown);
    const auto [width, height] = o.size.value_or(std::array{like.width, like.height});
    for (const Camera& camera : framing_cameras(dataset.mesh, centre, turn.path.places, up, width, height)) {
        turn.frames.push_back(shown);
        turn.frames.back().camera = camera;
    }
    return turn;
}

bool are_flashes(const std::vector<View>& views) {
    return std::ranges::all_of(views, [](const View& view) {
        if (view.light->kind != Light::Kind::near || view.camera_direction) return false;
        const Vec3d eye = view.camera.center();
        return (eye - view.light->place).norm() < 1e-3 * eye.norm();
    });
}

Revolution turn_of_lamp(const Dataset& dataset, const RenderOptions& o, const View& shown) {
    const std::vector<View> training = training_views(dataset);
    const Vec3d centre = surface_centre(dataset.mesh, dataset.grid);
    const bool near = training.front().light->kind == Light::Kind::near;
    std::vector<Vec3d> places;
    Vec3d intensity = Vec3d::Zero();
    for (const View& view : training) {
        places.push_back(near ? Vec3d(view.light->place - centre) : view.light->place);
        intensity += view.light->intensity / double(training.size());
    }
    Revolution turn{{}, closed_path(places, dataset.grid.normal(), o.turntable, o.full_circle), "lamp"};
    const bool flash = are_flashes(training);
    for (const Vec3d& place : turn.path.places) {
        View frame = shown;
        frame.light =
            Light{training.front().light->kind, near ? Vec3d(centre + place) : Vec3d(place.normalized()), intensity};
        if (flash) frame.camera = dataset.grid.camera_at(centre + place, "--turntable");
        turn.frames.push_back(frame);
    }
    return turn;
}

}  // namespace

void render_turntable(const RenderOptions& o, Fitted& fitted, const View& shown) {
    const Dataset& dataset = fitted.dataset();
    if (dataset.has_grid() && !o.light.empty())
        throw UserError("--light: over a grid it is the lamp that --turntable moves; leave one of the two out");
    const Revolution turn = dataset.has_grid() ? turn_of_lamp(dataset, o, shown) : turn_of_camera(dataset, o, shown);
    std::vector<NamedView> frames;
    for (const View& view : turn.frames) frames.push_back({fmt::format("turn{:03d}", frames.size()), view});
    const double least_share = render_frames(o, shown_fit(o, fitted), dataset, frames, "turntable");
    const bool circle = turn.path.span >= 2 * std::numbers::pi;
    log_info(fmt::format("turntable: {}, never more than {:.0f} degrees from the direction of a training {}{}",
                         circle ? "a full circle" : fmt::format("{:.0f} degrees and back", turn.path.span * degrees),
                         std::max(1.0, turn.path.farthest * degrees), turn.what,
                         circle ? "" : "; --full-circle goes all around"));
    describe_share(fitted, least_share);
}

}  // namespace radiafit::tools
