#include "geometry/ray_cast.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace radiafit {

namespace {

constexpr uint32_t leaf_size = 4;
constexpr int bins = 12;
// From this depth on nodes are halved, 32 levels at most, so that the stack never overflows.
constexpr int deepest_binned = 48;
constexpr int stack_size = deepest_binned + 40;

}  // namespace

/// Builds the hierarchy top-down by the binned surface area heuristic (Wald 2007, "On fast construction of SAH-based
/// bounding volume hierarchies").
struct RayCaster::Builder {
    struct Bounds {
        Vec3f low = Vec3f::Constant(std::numeric_limits<float>::infinity());
        Vec3f high = Vec3f::Constant(-std::numeric_limits<float>::infinity());
        void add(const Bounds& b) {
            low = low.cwiseMin(b.low);
            high = high.cwiseMax(b.high);
        }
        float half_area() const {
            const Vec3f d = high - low;
            return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
        }
        Vec3f middle() const { return 0.5f * (low + high); }
    };

    std::vector<Bounds> boxes;
    std::vector<uint32_t> order;
    std::vector<Node>& nodes;

    void build(uint32_t begin, uint32_t end, int depth) {
        const size_t self = nodes.size();
        Bounds box;
        for (uint32_t k = begin; k < end; ++k) box.add(boxes[order[k]]);
        nodes.push_back({box.low, box.high, begin, end - begin});
        if (end - begin <= leaf_size) return;

        const uint32_t middle = split(begin, end, depth);
        nodes[self].count = 0;
        build(begin, middle, depth + 1);
        nodes[self].first = static_cast<uint32_t>(nodes.size());
        build(middle, end, depth + 1);
    }

    uint32_t split(uint32_t begin, uint32_t end, int depth) {
        Bounds centers;
        for (uint32_t k = begin; k < end; ++k) {
            const Vec3f c = boxes[order[k]].middle();
            centers.add({c, c});
        }
        const Vec3f extent = centers.high - centers.low;
        int axis = 0;
        extent.maxCoeff(&axis);
        if (extent[axis] > 0 && depth < deepest_binned) {
            const float scale = bins / extent[axis];
            const auto bin = [&](uint32_t t) {
                return std::min(bins - 1, static_cast<int>((boxes[t].middle()[axis] - centers.low[axis]) * scale));
            };
            Bounds box[bins];
            uint32_t count[bins] = {};
            for (uint32_t k = begin; k < end; ++k) {
                box[bin(order[k])].add(boxes[order[k]]);
                ++count[bin(order[k])];
            }
            const int best = cheapest(box, count);
            const auto it =
                std::partition(order.begin() + begin, order.begin() + end, [&](uint32_t t) { return bin(t) <= best; });
            return static_cast<uint32_t>(it - order.begin());  // bins 0 and bins-1 are never empty
        }
        const uint32_t middle = begin + (end - begin) / 2;
        std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                         [&](uint32_t a, uint32_t b) { return boxes[a].middle()[axis] < boxes[b].middle()[axis]; });
        return middle;
    }

    /// The bin after which to split: the least sum of area times triangles.
    static int cheapest(const Bounds* box, const uint32_t* count) {
        float right_cost[bins] = {};
        Bounds right;
        uint32_t right_count = 0;
        for (int b = bins - 1; b > 0; --b) {
            right.add(box[b]);
            right_count += count[b];
            right_cost[b] = right.half_area() * float(right_count);
        }
        Bounds left;
        uint32_t left_count = 0;
        int best = 0;
        float best_cost = std::numeric_limits<float>::infinity();
        for (int b = 0; b + 1 < bins; ++b) {
            left.add(box[b]);
            left_count += count[b];
            const float cost = left.half_area() * float(left_count) + right_cost[b + 1];
            if (cost < best_cost) best = b, best_cost = cost;
        }
        return best;
    }
};

RayCaster::RayCaster(const Mesh& mesh) {
    std::vector<Triangle> triangles;
    Builder builder{{}, {}, nodes_};
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        if (is_degenerate(mesh, t)) continue;
        const auto& [i0, i1, i2] = mesh.triangles[t];
        Builder::Bounds box;
        for (const uint32_t v : mesh.triangles[t]) box.add({mesh.positions[v], mesh.positions[v]});
        builder.boxes.push_back(box);
        const Vec3d p0 = mesh.positions[i0].cast<double>();
        triangles.push_back({p0, mesh.positions[i1].cast<double>() - p0, mesh.positions[i2].cast<double>() - p0, t});
    }
    if (triangles.empty()) return;
    builder.order.resize(triangles.size());
    std::iota(builder.order.begin(), builder.order.end(), 0u);
    builder.build(0, static_cast<uint32_t>(triangles.size()), 0);
    triangles_.reserve(triangles.size());
    for (const uint32_t k : builder.order) triangles_.push_back(triangles[k]);
}

template <bool any_hit>
RayHit RayCaster::trace(const Vec3d& origin, const Vec3d& direction, double t_max, Faces faces) const {
    RayHit hit;
    if (nodes_.empty()) return hit;
    double nearest = t_max;
    // Large but finite where a component is zero, so that a ray along a face of a box gets 0 rather than NaN.
    const Vec3d inverse = direction.unaryExpr([](double d) { return std::abs(d) < 1e-280 ? 1e280 : 1 / d; });

    /// Where the ray enters a node, or infinity. Slabs are widened by a few roundings, so that no hit is lost.
    const auto enter = [&](const Node& node) {
        double t0 = 0, t1 = nearest;
        for (int k = 0; k < 3; ++k) {
            const double a = (node.low[k] - origin[k]) * inverse[k], b = (node.high[k] - origin[k]) * inverse[k];
            const double near = a < b ? a : b, far = (a < b ? b : a) * (1 + 1e-12);
            if (near > t0) t0 = near;
            if (far < t1) t1 = far;
        }
        return t0 * (1 - 1e-12) <= t1 ? t0 : std::numeric_limits<double>::infinity();
    };

    struct Entry {
        uint32_t node;
        double t;
    } stack[stack_size];
    int top = 0;
    stack[top++] = {0, 0};
    while (top > 0) {
        const Entry entry = stack[--top];
        if (entry.t > nearest) continue;
        const Node& node = nodes_[entry.node];
        if (node.count == 0) {
            const uint32_t left = entry.node + 1, right = node.first;
            const double t_left = enter(nodes_[left]), t_right = enter(nodes_[right]);
            const bool left_first = t_left <= t_right;
            const Entry near = left_first ? Entry{left, t_left} : Entry{right, t_right};
            const Entry far = left_first ? Entry{right, t_right} : Entry{left, t_left};
            if (far.t < std::numeric_limits<double>::infinity()) stack[top++] = far;
            if (near.t < std::numeric_limits<double>::infinity()) stack[top++] = near;
            continue;
        }
        // Möller and Trumbore 1997, "Fast, minimum storage ray/triangle intersection".
        for (uint32_t k = node.first; k < node.first + node.count; ++k) {
            const Triangle& triangle = triangles_[k];
            const Vec3d p = direction.cross(triangle.e2);
            const double determinant = triangle.e1.dot(p);  // > 0: met from the front
            if (determinant == 0 || (faces == Faces::front && determinant < 0)) continue;
            const double inverse_determinant = 1 / determinant;
            const Vec3d s = origin - triangle.p0;
            const double b1 = s.dot(p) * inverse_determinant;
            if (!(b1 >= 0 && b1 <= 1)) continue;
            const Vec3d q = s.cross(triangle.e1);
            const double b2 = direction.dot(q) * inverse_determinant;
            if (!(b2 >= 0 && b1 + b2 <= 1)) continue;
            const double t = triangle.e2.dot(q) * inverse_determinant;
            if (!(t > 0 && t < nearest)) continue;
            nearest = t;
            hit = {t, triangle.index, b1, b2};
            if (any_hit) return hit;
        }
    }
    return hit;
}

RayHit RayCaster::closest(const Vec3d& origin, const Vec3d& direction, double t_max, Faces faces) const {
    return trace<false>(origin, direction, t_max, faces);
}

bool RayCaster::occluded(const Vec3d& origin, const Vec3d& direction, double t_max) const {
    return trace<true>(origin, direction, t_max, Faces::both).hit();
}

}  // namespace radiafit
