#include "capture/coverage.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "geometry/raster.h"

namespace radiafit::tools {
namespace {

constexpr double least_better = 0.2;     // by which another frame must fit better than the mesh as it is to be reported
constexpr double nearly_as_good = 0.05;  // within this of the best fit, the plainer frame is reported

bool is_own(const OtherFrame& frame) { return frame.scale == 1 && frame.shift.isZero() && !frame.turned_over; }

Mesh moved(const Mesh& mesh, const OtherFrame& frame) {
    Mesh result;
    result.triangles = mesh.triangles;
    for (const Vec3f& p : mesh.positions)
        result.positions.push_back((frame.scale * p.cast<double>() + frame.shift).cast<float>());
    if (frame.turned_over)
        for (auto& triangle : result.triangles) std::swap(triangle[1], triangle[2]);
    return result;
}

bool has_masks(std::span<const Silhouette> views) {
    return std::any_of(views.begin(), views.end(), [](const Silhouette& v) { return !v.mask.empty(); });
}

/// Better is larger. Without masks a mesh that fills the images would seem best, so what counts is how many images see
/// it whole enough to be worth a fit.
double fit_of(const Mesh& mesh, std::span<const Silhouette> views, Coverage& coverage) {
    constexpr double worth_a_fit = 0.02;  // of an image's pixels
    coverage = measure_coverage(mesh, views);
    if (has_masks(views)) return coverage.overlap();
    size_t seen = 0;
    for (size_t i = 0; i < views.size(); ++i) seen += measure_coverage(mesh, views.subspan(i, 1)).share() > worth_a_fit;
    return double(seen) / double(views.size());
}

Vec3d centroid(const Mesh& mesh) {
    Vec3d sum = Vec3d::Zero();
    for (const Vec3f& p : mesh.positions) sum += p.cast<double>();
    return sum / double(mesh.vertex_count());
}

/// Where a photograph looks, in pixels: the centroid of its mask, or the principal point.
Vec2d aim(const Silhouette& view) {
    Vec2d sum = Vec2d::Zero();
    double count = 0;
    for (size_t i = 0; i < view.mask.size(); ++i)
        if (view.mask[i]) {
            sum += Vec2d(double(i % size_t(view.camera.width)) + 0.5, double(i / size_t(view.camera.width)) + 0.5);
            ++count;
        }
    return count > 0 ? Vec2d(sum / count) : Vec2d(view.camera.cx, view.camera.cy);
}

OtherFrame about_centroid(const Vec3d& centre, double scale, const Vec3d& target) {
    return {scale, target - scale * centre, false, {}};
}

/// The scale about `centre`, moved to `target`, at which the outline has the masks' area.
std::optional<double> fitting_scale(const Mesh& mesh, std::span<const Silhouette> views, const Vec3d& centre,
                                    const Vec3d& target) {
    double radius = 0, wanted = 0;
    for (const Vec3f& p : mesh.positions) radius = std::max(radius, (p.cast<double>() - centre).norm());
    for (const Silhouette& view : views) {
        const double area = double(std::count_if(view.mask.begin(), view.mask.end(), [](uint8_t m) { return m != 0; }));
        wanted += std::sqrt(area / 3.14159) * (view.camera.center() - target).norm() / view.camera.fx;
    }
    double scale = wanted / double(views.size()) / radius;
    for (int step = 0; step < 3; ++step) {  // the first guess takes the mesh for a ball
        if (!(scale > 0 && std::isfinite(scale))) return {};
        const Coverage now = measure_coverage(moved(mesh, about_centroid(centre, scale, target)), views);
        if (now.mesh == 0) return {};
        scale *= std::sqrt(double(now.object) / double(now.mesh));
    }
    return scale;
}

/// From the plainest mistake to the most involved.
std::vector<OtherFrame> usual_mistakes(const Mesh& mesh, std::span<const Silhouette> views) {
    std::vector<OtherFrame> frames;
    frames.push_back({1, Vec3d::Zero(), true, {}});
    for (const double unit : {100.0, 1000.0, 0.01, 0.001}) frames.push_back({unit, Vec3d::Zero(), false, {}});
    const std::optional<Vec3d> target = meeting_point(views);
    if (!target) return frames;
    const Vec3d centre = centroid(mesh);
    for (const double unit : {1.0, 100.0, 1000.0, 0.01, 0.001}) frames.push_back(about_centroid(centre, unit, *target));
    if (!has_masks(views)) return frames;
    if (const auto scale = fitting_scale(mesh, views, centre, *target)) {
        frames.push_back({*scale, Vec3d::Zero(), false, {}});
        frames.push_back(about_centroid(centre, *scale, *target));
    }
    return frames;
}

}  // namespace

std::optional<Vec3d> meeting_point(std::span<const Silhouette> views) {
    Mat3d sum = Mat3d::Zero();
    Vec3d right = Vec3d::Zero();
    for (const Silhouette& view : views) {
        const Camera& c = view.camera;
        const Vec2d pixel = aim(view);
        const Vec3d in_camera((pixel.x() - c.cx) / c.fx, (pixel.y() - c.cy) / c.fy, 1);
        const Vec3d ray = (c.cam_from_world_rotation.transpose() * in_camera).normalized();
        const Mat3d across = Mat3d::Identity() - ray * ray.transpose();
        sum += across;
        right += across * c.center();
    }
    if (sum.determinant() < 1e-9 * std::pow(double(views.size()), 3)) return {};
    return Vec3d(sum.inverse() * right);
}

Coverage& Coverage::operator+=(const Coverage& other) {
    object += other.object;
    both += other.both;
    mesh += other.mesh;
    return *this;
}

Coverage measure_coverage(const Mesh& mesh, std::span<const Silhouette> views) {
    std::vector<Rasterizer> rasters(static_cast<size_t>(thread_count()));
    std::vector<Coverage> counts(views.size());
    parallel_for(views.size(), 1, [&](size_t i, int worker) {
        Rasterizer& raster = rasters[size_t(worker)];
        raster.draw(mesh, views[i].camera);
        for (size_t pixel = 0; pixel < raster.pixels().size(); ++pixel) {
            const bool object = views[i].mask.empty() || views[i].mask[pixel];
            const bool seen = raster.pixels()[pixel].triangle != no_triangle;
            counts[i].object += object;
            counts[i].mesh += seen;
            counts[i].both += object && seen;
        }
    });
    Coverage sum;
    for (const Coverage& c : counts) sum += c;
    return sum;
}

OtherFrame find_other_frame(const Mesh& mesh, std::span<const Silhouette> views) {
    OtherFrame own;
    const double least = fit_of(mesh, views, own.coverage) + least_better;
    std::vector<OtherFrame> frames = usual_mistakes(mesh, views);
    std::vector<double> fits;
    for (OtherFrame& frame : frames) fits.push_back(fit_of(moved(mesh, frame), views, frame.coverage));
    const double best = *std::max_element(fits.begin(), fits.end());
    for (size_t i = 0; i < frames.size(); ++i)
        if (fits[i] >= least && fits[i] >= best - nearly_as_good) return frames[i];
    return own;
}

std::string describe(const OtherFrame& frame, const std::string& of_what) {
    if (is_own(frame)) return "";
    const std::string shift =
        fmt::format("shifted by ({:.4g}, {:.4g}, {:.4g})", frame.shift.x(), frame.shift.y(), frame.shift.z());
    const std::string scale = fmt::format("scaled by {:.4g}", frame.scale);
    const bool scaled = frame.scale != 1, shifted = !frame.shift.isZero();
    const std::string how = frame.turned_over ? "with its faces turned over"
                            : !shifted        ? scale
                            : !scaled         ? shift
                                              : scale + ", then " + shift + ",";
    const std::string why = frame.turned_over ? "they face inward"
                            : !shifted        ? "it is in another unit"
                            : !scaled         ? "it has another origin"
                                              : "it has another unit and another origin";
    return fmt::format("{} it would cover {:.0f} % of {}: {}", how, 100 * frame.coverage.share(), of_what, why);
}

}  // namespace radiafit::tools
