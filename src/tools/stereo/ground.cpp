#include "stereo/ground.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/rng.h"
#include "stereo/mesh_border.h"

namespace radiafit::tools {
namespace {

/// A triangle.
struct Facet {
    std::array<Vec3d, 3> corners;
    Vec3d centre, normal;
    double area = 0;
};

std::vector<Facet> facets_of(const Mesh& mesh) {
    std::vector<Facet> facets;
    for (const auto& t : mesh.triangles) {
        const auto corner = [&](size_t k) -> Vec3d { return mesh.positions[t[k]].cast<double>(); };
        const std::array<Vec3d, 3> at = {corner(0), corner(1), corner(2)};
        const Vec3d twice = (at[1] - at[0]).cross(at[2] - at[0]);
        const double area = twice.norm() / 2;
        if (area > 0) facets.push_back({at, (at[0] + at[1] + at[2]) / 3, twice / (2 * area), area});
    }
    return facets;
}

double total_area(const std::vector<Facet>& facets) {
    double sum = 0;
    for (const Facet& f : facets) sum += f.area;
    return sum;
}

/// `count` facets, each as likely as it is large.
std::vector<Facet> drawn(const std::vector<Facet>& facets, size_t count) {
    std::vector<double> sums;
    double sum = 0;
    for (const Facet& f : facets) sums.push_back(sum += f.area);
    Rng rng(1);
    std::vector<Facet> out;
    for (size_t i = 0; i < count; ++i) {
        const auto found = std::ranges::upper_bound(sums, double(rng.uniform()) * sum);
        out.push_back(facets[std::min(size_t(found - sums.begin()), facets.size() - 1)]);
    }
    return out;
}

bool on(const GroundPlane& plane, const Facet& f, double thickness, double least_cosine) {
    return std::abs(plane.height(f.centre)) <= thickness && plane.normal.dot(f.normal) >= least_cosine;
}

/// The least squares' plane of the facets on `plane`, weighted by area.
GroundPlane refined(const GroundPlane& plane, const std::vector<Facet>& facets, double thickness) {
    constexpr double least_cosine = 0.85;
    Vec3d centre = Vec3d::Zero();
    Mat3d moments = Mat3d::Zero();
    double area = 0;
    for (const Facet& f : facets)
        if (on(plane, f, thickness, least_cosine)) {
            area += f.area;
            centre += f.area * f.centre;
            Mat3d of_facet = 9 * f.centre * f.centre.transpose();
            for (const Vec3d& x : f.corners) of_facet += x * x.transpose();
            moments += f.area / 12 * of_facet;
        }
    if (area == 0) return plane;
    centre /= area;
    const Eigen::SelfAdjointEigenSolver<Mat3d> solver(moments / area - centre * centre.transpose());
    Vec3d normal = solver.eigenvectors().col(0);
    if (normal.dot(plane.normal) < 0) normal = -normal;
    return {normal, normal.dot(centre)};
}

/// To how many of twelve sides, as seen from the middle of what is above it, the plane goes on to near the region's
/// end.
int open_sides(const GroundPlane& plane, const std::vector<Facet>& facets, const SearchBall& region) {
    constexpr int sides = 12;
    constexpr double near_end = 0.75, least_cosine = 0.8;
    const double thickness = ground_thickness * region.radius;
    const Vec3d across = plane.normal.unitOrthogonal(), along = plane.normal.cross(across);
    Vec3d middle = Vec3d::Zero();
    double area = 0;
    for (const Facet& f : facets)
        if (plane.height(f.centre) > 3 * thickness) middle += f.area * f.centre, area += f.area;
    middle /= area;
    std::array<bool, sides> open{};
    for (const Facet& f : facets) {
        if (!on(plane, f, thickness, least_cosine)) continue;
        if ((f.centre - region.centre).norm() < near_end * region.radius) continue;
        const Vec3d from = f.centre - middle;
        const double turn = std::atan2(from.dot(along), from.dot(across)) / std::numbers::pi;  // -1 to 1
        open[size_t(std::clamp(int((turn + 1) / 2 * sides), 0, sides - 1))] = true;
    }
    return int(std::ranges::count(open, true));
}

bool is_ground(const GroundPlane& plane, const std::vector<Facet>& facets, std::span<const Camera> cameras,
               const SearchBall& region) {
    constexpr double least_on = 0.1, most_below = 0.03, least_above = 0.15, least_cameras = 0.95, least_middle = 0.05;
    constexpr double least_cosine = 0.8, least_up = 0.3;
    constexpr int least_open_sides = 6;
    const double thickness = ground_thickness * region.radius;
    double on_it = 0, below = 0, above = 0;
    for (const Facet& f : facets) {
        const double height = plane.height(f.centre);
        on_it += on(plane, f, thickness, least_cosine) ? f.area : 0;
        below += height < -3 * thickness ? f.area : 0;
        above += height > 3 * thickness ? f.area : 0;
    }
    const double all = total_area(facets);
    const auto cameras_above =
        std::ranges::count_if(cameras, [&](const Camera& c) { return plane.height(c.center()) > 0; });
    double up = 0;  // photographs may be stored on their side
    for (const int row : {0, 1}) {
        Vec3d mean = Vec3d::Zero();
        for (const Camera& c : cameras) mean += c.cam_from_world_rotation.row(row).transpose() / double(cameras.size());
        up = std::max(up, std::abs(mean.dot(plane.normal)));
    }
    return on_it >= least_on * all && below <= most_below * all && above >= least_above * all &&
           double(cameras_above) >= least_cameras * double(cameras.size()) && up >= least_up &&
           plane.height(region.centre) >= least_middle * region.radius &&
           open_sides(plane, facets, region) >= least_open_sides;
}

std::vector<double> heights(const Mesh& mesh, const GroundPlane& ground, double above) {
    std::vector<double> out;
    for (const Vec3f& p : mesh.positions) out.push_back(ground.height(p.cast<double>()) - above);
    return out;
}

}  // namespace

std::optional<GroundPlane> find_ground(const Mesh& mesh, std::span<const Camera> cameras, const SearchBall& region) {
    constexpr size_t tries = 400, judges = 4000;
    constexpr double coarse = 3 * ground_thickness, coarse_cosine = 0.85;
    const std::vector<Facet> facets = facets_of(mesh);
    if (facets.empty()) return {};
    const std::vector<Facet> sample = drawn(facets, judges);
    struct Candidate {
        GroundPlane plane;
        size_t votes;
    };
    std::vector<Candidate> candidates;
    for (size_t i = 0; i < tries; ++i) {
        const Facet& f = sample[i * (judges / tries)];
        const GroundPlane plane{f.normal, f.normal.dot(f.centre)};
        const auto votes = size_t(std::ranges::count_if(
            sample, [&](const Facet& g) { return on(plane, g, coarse * region.radius, coarse_cosine); }));
        candidates.push_back({plane, votes});
    }
    std::ranges::stable_sort(candidates, std::greater(), &Candidate::votes);
    constexpr size_t most_tried = 6;
    std::vector<GroundPlane> refused;
    const auto is_new = [&](const GroundPlane& plane) {
        return std::ranges::none_of(refused, [&](const GroundPlane& other) {
            return plane.normal.dot(other.normal) > 0.98 &&
                   std::abs(plane.height(other.normal * other.offset)) < 2 * coarse * region.radius;
        });
    };
    for (const Candidate& candidate : candidates) {
        if (!is_new(candidate.plane)) continue;
        GroundPlane plane = candidate.plane;
        for (const double share : {3.0, 2.0, 1.0, 1.0})
            plane = refined(plane, facets, share * ground_thickness * region.radius);
        if (is_ground(plane, facets, cameras, region)) return plane;
        refused.push_back(candidate.plane);
        if (refused.size() == most_tried) break;
    }
    return {};
}

Mesh above_ground(const Mesh& mesh, const GroundPlane& ground, const SearchBall& region) {
    return clipped(mesh, heights(mesh, ground, ground_thickness * region.radius));
}

Mesh within_disc(const Mesh& mesh, const GroundPlane& ground, const Mesh& object) {
    constexpr double wider = 1.15;
    if (object.positions.empty()) return mesh;
    const auto in_plane = [&](const Vec3f& p) -> Vec3d {
        const Vec3d x = p.cast<double>();
        return x - ground.height(x) * ground.normal;
    };
    Vec3d middle = Vec3d::Zero();
    for (const Vec3f& p : object.positions) middle += in_plane(p) / double(object.vertex_count());
    double radius = 0;
    for (const Vec3f& p : object.positions) radius = std::max(radius, (in_plane(p) - middle).norm());
    std::vector<double> within;
    for (const Vec3f& p : mesh.positions) within.push_back(wider * radius - (in_plane(p) - middle).norm());
    return clipped(mesh, within);
}

}  // namespace radiafit::tools
