#include "reference/triangulation.h"

#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <compare>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>

namespace radiafit::fits {
namespace {

using Triangle = std::array<uint32_t, 3>;
using Segment = std::array<uint32_t, 2>;

double cross(const Vec2d& a, const Vec2d& b) { return a.x() * b.y() - a.y() * b.x(); }
double twice_area(const Vec2d& a, const Vec2d& b, const Vec2d& c) { return cross(b - a, c - a); }

/// Indices of one point out of each clump, in ascending order.
std::vector<uint32_t> distinct(std::span<const Vec2d> points, const Vec2d& low, double grid) {
    struct InCell {
        std::array<int64_t, 2> cell;
        uint32_t point;
        auto operator<=>(const InCell&) const = default;
    };
    std::vector<InCell> cells;
    for (uint32_t i = 0; i < points.size(); ++i) {
        const Vec2d cell = (points[i] - low) / grid;
        cells.push_back({{std::llround(cell.x()), std::llround(cell.y())}, i});
    }
    std::sort(cells.begin(), cells.end());
    std::vector<uint32_t> kept;
    for (size_t i = 0; i < cells.size(); ++i)
        if (i == 0 || cells[i].cell != cells[i - 1].cell) kept.push_back(cells[i].point);
    std::sort(kept.begin(), kept.end());
    return kept;
}

/// Qhull's state and the text of its errors, freed together.
class Hull {
public:
    Hull() : messages_(open_memstream(&text_, &length_)) {
        if (!messages_) throw std::bad_alloc();
        qh_zero(&state_, messages_);
    }
    ~Hull() {
        qh_freeqhull(&state_, !qh_ALL);
        int left = 0, bytes = 0;
        qh_memfreeshort(&state_, &left, &bytes);
        std::fclose(messages_);
        std::free(text_);  // NOLINT(cppcoreguidelines-no-malloc): open_memstream took it
    }
    Hull(const Hull&) = delete;
    Hull& operator=(const Hull&) = delete;

    /// Delaunay triangles of xy [count][2], in either orientation.
    std::vector<Triangle> triangulate(std::vector<double>& xy) {
        // Qt: cocircular points' cells cut into triangles; Qbb: lifted coordinate scaled; Qz: a point at infinity, so
        // that cocircular sets have a lower hull.
        char command[] = "qhull d Qt Qbb Qz";
        if (qh_new_qhull(&state_, 2, int(xy.size() / 2), xy.data(), False, command, nullptr, messages_) != 0) {
            std::fflush(messages_);
            throw std::runtime_error(std::string("Delaunay triangulation failed: ") + (text_ ? text_ : ""));
        }
        std::vector<Triangle> triangles;
        qhT* qh = &state_;
        for (facetT* facet = qh->facet_list; facet && facet->next; facet = facet->next) {
            if (facet->upperdelaunay) continue;
            Triangle t{};
            size_t corners = 0;
            for (void** at = &facet->vertices->e[0].p; *at && corners < 3; ++at)
                t[corners++] = uint32_t(qh_pointid(qh, static_cast<vertexT*>(*at)->point));
            if (corners == 3) triangles.push_back(t);
        }
        return triangles;
    }

private:
    char* text_ = nullptr;
    size_t length_ = 0;
    std::FILE* messages_;
    qhT state_;
};

/// Segments between neighbours of points that lie on one line.
std::vector<Segment> chain(std::span<const Vec2d> points, std::vector<uint32_t> kept, const Vec2d& direction) {
    if (kept.size() == 1) return {{kept[0], kept[0]}};
    std::stable_sort(kept.begin(), kept.end(),
                     [&](uint32_t a, uint32_t b) { return direction.dot(points[a]) < direction.dot(points[b]); });
    std::vector<Segment> segments;
    for (size_t i = 1; i < kept.size(); ++i) segments.push_back({kept[i - 1], kept[i]});
    return segments;
}

}  // namespace

Triangulation::Triangulation(std::span<const Vec2d> points) : points_(points.begin(), points.end()) {
    if (points.empty()) throw std::invalid_argument("Triangulation: no points");
    Vec2d low = points[0], high = points[0];
    for (const Vec2d& p : points) {
        if (!p.allFinite()) throw std::invalid_argument("Triangulation: a point that is not finite");
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double extent = std::max((high - low).maxCoeff(), 1e-300), grid = 1e-6 * extent;
    const std::vector<uint32_t> kept = distinct(points, low, grid);

    // Are all points on one line, as far as doubles can distinguish triangles from slivers?
    const auto farther = [&](const Vec2d& from) {
        return [&](uint32_t a, uint32_t b) { return (points[a] - from).norm() < (points[b] - from).norm(); };
    };
    const Vec2d one_end = points[*std::max_element(kept.begin(), kept.end(), farther(points[kept[0]]))];
    const Vec2d other_end = points[*std::max_element(kept.begin(), kept.end(), farther(one_end))];
    const Vec2d direction = (other_end - one_end) / extent;
    double width = 0;
    for (uint32_t i : kept) width = std::max(width, std::abs(cross(direction, points[i] - one_end)));
    if (kept.size() < 3 || width < grid) {
        border_ = chain(points, kept, direction);
        return;
    }

    std::vector<double> xy;
    for (uint32_t i : kept) {
        xy.push_back((points[i].x() - low.x()) / extent);
        xy.push_back((points[i].y() - low.y()) / extent);
    }
    std::vector<Segment> sides;
    for (Triangle t : Hull().triangulate(xy)) {
        for (uint32_t& i : t) i = kept[i];
        const double area = twice_area(points[t[0]], points[t[1]], points[t[2]]);
        if (std::abs(area) < 1e-12 * extent * extent) continue;  // a sliver along the hull
        if (area < 0) std::swap(t[1], t[2]);
        // Qhull's order of facets is arbitrary: begin with the least corner, then sort.
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        triangles_.push_back(t);
        for (size_t i = 0; i < 3; ++i) {
            const auto [low_end, high_end] = std::minmax(t[i], t[(i + 1) % 3]);
            sides.push_back({low_end, high_end});
        }
    }
    std::sort(triangles_.begin(), triangles_.end());
    std::sort(sides.begin(), sides.end());
    for (size_t i = 0; i < sides.size(); ++i) {  // the side of a single triangle is there once
        const bool as_before = i > 0 && sides[i] == sides[i - 1];
        const bool as_next = i + 1 < sides.size() && sides[i] == sides[i + 1];
        if (!as_before && !as_next) border_.push_back(sides[i]);
    }
    bottom_ = low.y();
    strip_height_ = (high.y() - low.y()) / strip_count;
    strips_.resize(strip_count);
    for (uint32_t i = 0; i < triangles_.size(); ++i) {
        Eigen::AlignedBox2d box(points_[triangles_[i][0]]);
        box.extend(points_[triangles_[i][1]]).extend(points_[triangles_[i][2]]);
        for (size_t s = strip_of(box.min().y()); s <= strip_of(box.max().y()); ++s) strips_[s].push_back({box, i});
    }
}

size_t Triangulation::strip_of(double y) const {
    const double strip = (y - bottom_) / strip_height_;
    return strip > 0 ? size_t(std::min(strip, double(strip_count - 1))) : 0;
}

Triangulation::Weights Triangulation::at(const Vec2d& place) const {
    if (strips_.empty()) return nearest(points_, border_, place);
    for (const auto& [box, i] : strips_[strip_of(place.y())]) {
        if (!box.contains(place)) continue;
        const Triangle& t = triangles_[i];
        const Vec2d &a = points_[t[0]], &b = points_[t[1]], &c = points_[t[2]];
        const double wa = twice_area(b, c, place), wb = twice_area(c, a, place), wc = twice_area(a, b, place);
        const double sum = wa + wb + wc;
        const double rounding = -1e-12 * sum;  // a place on a shared side is in both triangles, never in none
        if (wa < rounding || wb < rounding || wc < rounding) continue;
        const double a0 = std::max(wa, 0.0), b0 = std::max(wb, 0.0), c0 = std::max(wc, 0.0);
        return {t, {a0 / (a0 + b0 + c0), b0 / (a0 + b0 + c0), c0 / (a0 + b0 + c0)}, true};
    }
    return nearest(points_, border_, place);
}

Triangulation::Weights Triangulation::nearest(std::span<const Vec2d> points, std::span<const Segment> segments,
                                              const Vec2d& place) {
    Weights best{};
    double least = std::numeric_limits<double>::infinity();
    for (const Segment& s : segments) {
        const Vec2d along = points[s[1]] - points[s[0]];
        const double length = along.squaredNorm();
        const double u = length > 0 ? std::clamp(along.dot(place - points[s[0]]) / length, 0.0, 1.0) : 0;
        const double distance = (points[s[0]] + u * along - place).squaredNorm();
        if (distance >= least) continue;
        least = distance;
        best = {{s[0], s[1], s[0]}, {1 - u, u, 0}, false};
    }
    return best;
}

}  // namespace radiafit::fits
