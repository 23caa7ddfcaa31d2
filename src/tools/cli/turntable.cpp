#include "cli/turntable.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "base/log.h"
#include "cli/pictures.h"
#include "cli/video.h"
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

std::string frame_name(size_t i) { return fmt::format("turn{:03d}", i); }

}  // namespace

void describe_share(double share) {
    if (share < 1)
        log_warning(
            fmt::format("lamp or camera are far from those of the training images: the picture shows {:.0f} % of the "
                        "fit, the rest is Lambertian",
                        100 * share));
}

void render_turntable(const RenderOptions& o, Fitted& fitted, const View& shown) {
    const Dataset& dataset = fitted.dataset();
    if (dataset.has_grid() && !o.light.empty())
        throw UserError("--light: over a grid it is the lamp that --turntable moves; leave one of the two out");
    const Contestant fit = contestant_of(fitted);
    const Revolution turn = dataset.has_grid() ? turn_of_lamp(dataset, o, shown) : turn_of_camera(dataset, o, shown);

    std::optional<Pictures> pictures;
    if (!o.output.empty()) pictures.emplace(o.output, o.background);
    for (size_t i = 0; i < turn.frames.size() && pictures; ++i) pictures->check(frame_name(i), {".png", ".exr"});
    std::optional<Video> video;
    if (!o.video.empty()) video.emplace(o.video, o.background);
    double least_share = 1;
    Progress progress("turntable", turn.frames.size());
    for (size_t i = 0; i < turn.frames.size(); ++i) {
        if (fit.share_of_fit) least_share = std::min(least_share, fit.share_of_fit(turn.frames[i]));
        const LightImage frame = render(fit, dataset, turn.frames[i], o.points());
        if (pictures) pictures->add(frame_name(i), frame);
        if (video) video->add(frame);
        progress.advance();
    }
    progress.finish();
    if (video) video->encode();
    if (pictures) pictures->commit();
    if (video) video->commit();
    const bool circle = turn.path.span >= 2 * std::numbers::pi;
    log_info(fmt::format("turntable: {}, never more than {:.0f} degrees from the direction of a training {}{}",
                         circle ? "a full circle" : fmt::format("{:.0f} degrees and back", turn.path.span * degrees),
                         std::max(1.0, turn.path.farthest * degrees), turn.what,
                         circle ? "" : "; --full-circle goes all around"));
    describe_share(least_share);
}

}  // namespace radiafit::tools
