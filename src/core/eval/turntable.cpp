#include "eval/turntable.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace radiafit {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double blur = pi / 9;                  // of direction: standard deviation of the Gaussian
constexpr double highest = 89 * pi / 180;        // above, an azimuth says nothing of where a place is
constexpr double widest_field = 100 * pi / 180;  // of view: beyond, a picture is all distortion

struct Place {
    double azimuth, elevation, distance;
};

/// Places by azimuth and elevation.
class AroundAxis {
public:
    explicit AroundAxis(const Vec3d& axis)
        : axis_(axis),
          east_((std::abs(axis.z()) < 0.9 ? Vec3d::UnitZ() : Vec3d::UnitX()).cross(axis).normalized()),
          north_(axis.cross(east_)) {}

    Place to_place(const Vec3d& at) const {
        const Vec3d d = at.normalized();
        return {std::atan2(d.dot(north_), d.dot(east_)), std::asin(std::clamp(d.dot(axis_), -1.0, 1.0)), at.norm()};
    }
    Vec3d to_vector(const Place& p) const {
        return p.distance * (std::sin(p.elevation) * axis_ +
                             std::cos(p.elevation) * (std::cos(p.azimuth) * east_ + std::sin(p.azimuth) * north_));
    }

private:
    Vec3d axis_, east_, north_;
};

struct Run {
    double from, to;  ///< azimuths; 2 pi apart: all around
};

/// The range of azimuths that holds the most places without a wide gap between them.
Run longest_run(const std::vector<Place>& places) {
    std::vector<Place> round;
    for (const Place& p : places)
        if (std::abs(p.elevation) <= highest) round.push_back(p);
    if (round.empty()) return {0, 2 * pi};  // all around the axis
    std::ranges::sort(round, {}, &Place::azimuth);
    const size_t n = round.size();
    for (size_t i = 0; i <= n; ++i) {
        round.push_back(round[i]);
        round.back().azimuth += 2 * pi;
    }
    const auto gap_after = [&](size_t i) {
        const double along = std::cos(0.5 * (round[i].elevation + round[i + 1].elevation));
        return along * (round[i + 1].azimuth - round[i].azimuth) > widest_gap;
    };
    Run best{round[0].azimuth, round[0].azimuth + 2 * pi};
    size_t most = 0;
    for (size_t first = 1; first <= n; ++first) {
        if (!gap_after(first - 1)) continue;
        size_t last = first;
        while (!gap_after(last)) ++last;  // at first - 1 + n at the latest
        if (last - first + 1 > most) most = last - first + 1, best = {round[first].azimuth, round[last].azimuth};
    }
    return best;
}

/// The weighted mean of the places near this azimuth, raised by `above` standard deviations of their elevation.
Place typical(const std::vector<Place>& places, double azimuth, double above) {
    double weights = 0, elevation = 0, squares = 0, distance = 0;
    for (const Place& p : places) {
        const double round = std::cos(p.elevation);  // of its parallel, against the equator
        const double apart = round * std::remainder(p.azimuth - azimuth, 2 * pi) / blur;
        const double weight = round * std::exp(-0.5 * apart * apart) + 1e-9;  // everything counts a little
        weights += weight;
        elevation += weight * p.elevation;
        squares += weight * p.elevation * p.elevation;
        distance += weight * p.distance;
    }
    elevation /= weights;
    const double deviation = std::sqrt(std::max(0.0, squares / weights - elevation * elevation));
    return {azimuth, elevation + above * deviation, distance / weights};
}

}  // namespace

ClosedPath closed_path(std::span<const Vec3d> given, const Vec3d& axis, int count, bool full_circle) {
    const AroundAxis around(axis);
    std::vector<Place> places;
    for (const Vec3d& at : given) places.push_back(around.to_place(at));
    const Run run = longest_run(places);
    const bool circle = full_circle || run.to - run.from >= 2 * pi;
    ClosedPath path;
    path.span = circle ? 2 * pi : run.to - run.from;
    for (int i = 0; i < count; ++i) {
        const double turn = 2 * pi * i / count;
        const double middle = 0.5 * (run.from + run.to);
        path.places.push_back(
            around.to_vector(circle ? typical(places, run.from + turn, 0)
                                    : typical(places, middle + 0.5 * path.span * std::sin(turn), std::cos(turn))));
        double nearest = -1;
        for (const Vec3d& at : given) nearest = std::max(nearest, at.normalized().dot(path.places.back().normalized()));
        path.farthest = std::max(path.farthest, std::acos(std::clamp(nearest, -1.0, 1.0)));
    }
    return path;
}

Vec3d up_of(std::span<const View> views) {
    Vec3d up = Vec3d::Zero();
    for (const View& view : views) up -= view.camera.cam_from_world_rotation.row(1).transpose();
    return up.norm() > 1e-6 * double(views.size()) ? Vec3d(up.normalized()) : Vec3d::UnitZ();
}

std::vector<Camera> framing_cameras(const Mesh& mesh, const Vec3d& centre, std::span<const Vec3d> places,
                                    const Vec3d& up, int width, int height) {
    std::vector<Camera> cameras;
    double focal = std::numeric_limits<double>::infinity();
    const double half_x = (0.5 - frame_margin) * width, half_y = (0.5 - frame_margin) * height;
    for (const Vec3d& place : places) {
        cameras.push_back(Camera::look_at(centre + place, centre, up, 1, width, height));
        for (const auto& triangle : mesh.triangles)
            for (const uint32_t corner : triangle) {
                const Vec3d at = cameras.back().to_camera(mesh.positions[corner].cast<double>());
                if (at.z() <= 1e-3 * place.norm()) continue;  // beside or behind the camera: nothing brings it in
                focal = std::min({focal, half_x * at.z() / std::max(std::abs(at.x()), 1e-30),
                                  half_y * at.z() / std::max(std::abs(at.y()), 1e-30)});
            }
    }
    const double least = 0.5 * std::min(width, height) / std::tan(0.5 * widest_field);
    focal = std::isfinite(focal) ? std::max(focal, least) : least;
    for (Camera& camera : cameras) camera.fx = camera.fy = focal;
    return cameras;
}

}  // namespace radiafit
