#include "synthetic/paint.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/rng.h"

namespace radiafit {
namespace {

enum Pattern : uint32_t { plain, striped, chequered, dotted, pattern_count };

std::array<Vec3f, 3> corners(const Mesh& mesh, size_t triangle) {
    const auto& t = mesh.triangles[triangle];
    return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

float area(const Mesh& mesh, size_t triangle) {
    const auto [a, b, c] = corners(mesh, triangle);
    return 0.5f * (b - a).cross(c - a).norm();
}

/// Random points on the surface that keep a distance from each other.
std::vector<Vec3f> strew(const Mesh& mesh, float distance, Rng& rng) {
    std::vector<double> sums;
    double total = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) sums.push_back(total += double(area(mesh, t)));
    const auto tries = size_t(10 * total / double(distance * distance));
    std::vector<Vec3f> points;
    for (size_t i = 0; i < tries; ++i) {
        const double at = total * (double(rng.bits()) + 0.5) * 0x1p-32;
        const auto t = size_t(std::lower_bound(sums.begin(), sums.end(), at) - sums.begin());
        const auto [a, b, c] = corners(mesh, std::min(t, mesh.triangle_count() - 1));
        const float root = std::sqrt(rng.uniform()), u = rng.uniform();
        const Vec3f x = (1 - root) * a + root * (1 - u) * b + root * u * c;
        const bool apart = std::none_of(points.begin(), points.end(),
                                        [&](const Vec3f& p) { return (p - x).squaredNorm() < distance * distance; });
        if (apart) points.push_back(x);
    }
    return points;
}

}  // namespace

float mean_edge(const Mesh& mesh) {
    double sum = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) sum += double(area(mesh, t));
    return float(std::sqrt(sum / double(mesh.triangle_count()) * 4 / std::sqrt(3.0)));
}

Paint::Paint(const Mesh& mesh, const std::string& shape, uint64_t seed)
    : period_(pattern_edges * mean_edge(mesh)), regions_(regions(shape, seed)) {
    Rng rng(seed, 4);
    const auto region_measure = [&](size_t r, const Vec3f& x) {
        return (x - regions_[r].site).norm() / regions_[r].reach;
    };
    for (const Vec3f& site : strew(mesh, 0.8f * cell_edges * mean_edge(mesh), rng)) {
        Cell cell;
        cell.site = site;
        cell.region = 0;
        for (uint32_t r = 1; r < regions_.size(); ++r)
            if (region_measure(r, site) < region_measure(cell.region, site)) cell.region = r;
        const std::vector<Vec3f>& palette = regions_[cell.region].palette;
        const auto count = uint32_t(palette.size());
        const uint32_t first = rng.index(count);
        cell.colors[0] = palette[first];
        cell.colors[1] = palette[(first + 1 + rng.index(count - 1)) % count];
        cell.pattern = rng.index(pattern_count);
        const Vec3f random(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
        const Vec3f across = (random + Vec3f(0.01f, 0, 0)).normalized();
        cell.across = across / period_;
        cell.along = across.unitOrthogonal() / period_;
        cells_.push_back(cell);
    }
    // A site that is nearest somewhere in a triangle is hardly farther from its middle than the nearest one there.
    candidate_offsets_ = {0};
    std::vector<float> distances(cells_.size());
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const auto [a, b, c] = corners(mesh, t);
        const Vec3f middle = (a + b + c) / 3;
        const float radius = std::max({(a - middle).norm(), (b - middle).norm(), (c - middle).norm()});
        for (size_t s = 0; s < cells_.size(); ++s) distances[s] = (cells_[s].site - middle).norm();
        const float limit = *std::min_element(distances.begin(), distances.end()) + 2.001f * radius;
        for (size_t s = 0; s < cells_.size(); ++s)
            if (distances[s] <= limit) candidates_.push_back(uint32_t(s));
        candidate_offsets_.push_back(uint32_t(candidates_.size()));
    }
}

Vec3f Paint::pattern_color(const Cell& cell, const Vec3f& x) const {
    const Vec3f from_site = x - cell.site;
    const auto half_periods = [&](const Vec3f& axis) { return int(std::floor(2 * axis.dot(from_site))); };
    switch (cell.pattern) {
        case striped:
            return cell.colors[half_periods(cell.across) & 1];
        case chequered:
            return cell.colors[(half_periods(cell.across) + half_periods(cell.along)) & 1];
        case dotted:
            return cell.colors[from_site.squaredNorm() < 0.25f * period_ * period_ ? 1 : 0];
        default:
            return cell.colors[0];
    }
}

Paint::Coat Paint::at(uint32_t triangle, const Vec3f& x) const {
    const Cell* nearest = nullptr;
    float least = std::numeric_limits<float>::infinity();
    for (uint32_t k = candidate_offsets_[triangle]; k < candidate_offsets_[triangle + 1]; ++k) {
        const Cell& cell = cells_[candidates_[k]];
        const float distance2 = (x - cell.site).squaredNorm();
        if (distance2 < least) {
            least = distance2;
            nearest = &cell;
        }
    }
    return {pattern_color(*nearest, x), &regions_[nearest->region].gloss};
}

}  // namespace radiafit
