#include "geometry/raster.h"

#include <algorithm>
#include <cmath>

namespace radiafit {

namespace {

constexpr double smallest_depth = 1e-6;
constexpr double farthest = 1e60;  // pixels: products of coordinates, their differences and inverses stay finite
constexpr double snap = 16384;     // 2^14: 26-bit coordinates, whose products a double holds exactly

/// a x + b y + c, in pixels from the image's middle.
struct Plane {
    double a, b, c;
    double row(double y) const { return b * y + c; }
};

/// Positive inside. A front-facing triangle runs counter-clockwise to the eye, that is, with negative
/// (x1-x0)(y2-y0) - (x2-x0)(y1-y0), for y points down; hence the order of the terms.
/// Swapping p and q negates every term exactly: the two triangles of an edge never disagree about a pixel.
Plane edge_function(const Vec3d& p, const Vec3d& q) {
    return {q.y() - p.y(), p.x() - q.x(), q.x() * p.y() - p.x() * q.y()};
}

/// A pixel centre is inside if the edge function exceeds this. Edge functions are multiples of 2^-28, so the constant
/// lets zero pass, and nothing else: pixel centres on a left or top edge are inside.
double threshold(const Plane& edge) { return edge.a > 0 || (edge.a == 0 && edge.b > 0) ? -0x1p-30 : 0; }

/// What bounds a row of a triangle on its left or on its right: two edges, or twice the only one.
struct Side {
    Plane edges[2];
    double to_crossing[2], thresholds[2];
    double rows[2] = {0, 0};  ///< of the current row
    int count = 0;

    void add(const Plane& edge) {
        for (int k = count++; k < 2; ++k) {
            edges[k] = edge;
            to_crossing[k] = -1 / edge.a;
            thresholds[k] = threshold(edge);
        }
    }
    void enter(double y) {
        for (int k = 0; k < 2; ++k) rows[k] = edges[k].row(y);
    }
    double crossing(int k) const { return rows[k] * to_crossing[k]; }
    bool inside(double x) const {
        return (edges[0].a * x + rows[0] > thresholds[0]) & (edges[1].a * x + rows[1] > thresholds[1]);
    }
};

/// The columns of a triangle's rows.
struct Spans {
    Side left, right;
    int x_begin, x_end;  ///< bounds of the triangle within the image
    double origin;       ///< x of column 0's pixel centre
    int begin = 0, end = 0;

    /// Guesses by division, then lets the exact tests decide.
    void enter(double y) {
        left.enter(y);
        right.enter(y);
        const double low = x_begin, high = x_end;
        const double first = std::max(left.crossing(0), left.crossing(1)) - origin;
        const double last = std::min(right.crossing(0), right.crossing(1)) - origin;
        begin = static_cast<int>(std::ceil(std::clamp(first, low, high)));
        end = static_cast<int>(std::floor(std::clamp(last, low - 1, high - 1))) + 1;
        while (begin > x_begin && left.inside(origin + (begin - 1))) --begin;
        while (begin < x_end && !left.inside(origin + begin)) ++begin;
        while (end < x_end && right.inside(origin + end)) ++end;
        while (end > x_begin && !right.inside(origin + (end - 1))) --end;
    }
};

}  // namespace

void Rasterizer::draw(const Mesh& mesh, const Camera& camera) {
    const int width = camera.width, height = camera.height;
    pixels_.assign(size_t(width) * height, RasterPixel{});
    inverse_depth_.assign(size_t(width) * height, 0.0f);

    // Measured from the image's middle, coordinates are small and edge functions exact.
    const int middle_x = width / 2, middle_y = height / 2;
    projected_.resize(mesh.vertex_count());
    for (size_t v = 0; v < projected_.size(); ++v) {
        const Vec3d p = camera.project(mesh.positions[v].cast<double>());
        const bool in_front = p.z() > smallest_depth && std::abs(p.x()) < farthest && std::abs(p.y()) < farthest;
        projected_[v] = {std::nearbyint((p.x() - middle_x) * snap) / snap,
                         std::nearbyint((p.y() - middle_y) * snap) / snap, in_front ? 1 / p.z() : 0};
    }

    const double left = 0.5 - middle_x, top = 0.5 - middle_y;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        const auto& [i0, i1, i2] = mesh.triangles[t];
        const Vec3d &p0 = projected_[i0], &p1 = projected_[i1], &p2 = projected_[i2];
        if (p0.z() == 0 || p1.z() == 0 || p2.z() == 0) continue;

        const Plane edges[3] = {edge_function(p1, p2), edge_function(p2, p0), edge_function(p0, p1)};
        // Twice the area, by differences: the planes' constants would cancel.
        const double area = edges[2].a * edges[1].b - edges[1].a * edges[2].b;
        if (!(area > 0)) continue;

        // Pixel centres within the bounds, clamped before they become integers.
        const auto first = [](double low, double origin, int size) {
            return static_cast<int>(std::clamp(std::ceil(low - origin), 0.0, double(size)));
        };
        const auto last = [](double high, double origin, int size) {
            return static_cast<int>(std::clamp(std::floor(high - origin) + 1, 0.0, double(size)));
        };
        const int x_begin = first(std::min({p0.x(), p1.x(), p2.x()}), left, width);
        const int x_end = last(std::max({p0.x(), p1.x(), p2.x()}), left, width);
        int y_begin = first(std::min({p0.y(), p1.y(), p2.y()}), top, height);
        int y_end = last(std::max({p0.y(), p1.y(), p2.y()}), top, height);
        if (x_begin >= x_end || y_begin >= y_end) continue;
        if (is_degenerate(mesh, t)) continue;

        const double inverse_area = 1 / area;
        Spans spans{{}, {}, x_begin, x_end, left};
        for (const Plane& edge : edges) {
            if (edge.a != 0) {
                (edge.a > 0 ? spans.left : spans.right).add(edge);
            } else {  // bounds the rows
                while (y_begin < y_end && !(edge.row(top + y_begin) > threshold(edge))) ++y_begin;
                while (y_begin < y_end && !(edge.row(top + y_end - 1) > threshold(edge))) --y_end;
            }
        }
        // b1/z, b2/z and 1/z are linear in the image. Measured from the bounds' first pixel centre, where edge
        // functions are still exact, they stay accurate in slivers.
        const double x0 = left + x_begin, y0 = top + y_begin;
        const auto weight = [&](const Plane& e, double inverse_z) {
            const double s = inverse_z * inverse_area;
            return Plane{e.a * s, e.b * s, (e.a * x0 + e.row(y0)) * s};
        };
        const Plane over0 = weight(edges[0], p0.z()), over1 = weight(edges[1], p1.z()),
                    over2 = weight(edges[2], p2.z());
        const Plane over = {over0.a + over1.a + over2.a, over0.b + over1.b + over2.b, over0.c + over1.c + over2.c};

        for (int y = y_begin; y < y_end; ++y) {
            spans.enter(top + y);
            const double dy = y - y_begin;
            const double row = over.row(dy), row1 = over1.row(dy), row2 = over2.row(dy);
            RasterPixel* pixels = pixels_.data() + size_t(y) * width;
            float* depths = inverse_depth_.data() + size_t(y) * width;
            for (int x = spans.begin; x < spans.end; ++x) {
                const double dx = x - x_begin;
                const double inverse_z = over.a * dx + row;
                if (!(float(inverse_z) > depths[x])) continue;
                depths[x] = float(inverse_z);
                const double z = 1 / inverse_z;
                const double b1 = (over1.a * dx + row1) * z, b2 = (over2.a * dx + row2) * z;
                pixels[x] = {t, float(std::clamp(b1, 0.0, 1.0)), float(std::clamp(b2, 0.0, 1.0))};
            }
        }
    }
}

}  // namespace radiafit
