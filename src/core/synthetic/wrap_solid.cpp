#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unordered_map>

#include "synthetic/closed_mesh.h"

namespace radiafit {
namespace {

/// The sphere's mesh on its way to a solid.
class Wrap {
public:
    Wrap(const Solid& solid, std::vector<Vec3d> positions, std::vector<std::array<uint32_t, 3>> triangles)
        : solid_(solid), positions_(std::move(positions)), triangles_(std::move(triangles)) {}

    /// Every vertex but the tips (the first ones) towards the middle of its ring, big triangles pulling more, and back
    /// onto the surface.
    void relax() {
        std::vector<Vec3d> sums(positions_.size(), Vec3d::Zero());
        std::vector<double> weights(positions_.size(), 0);
        for (const auto& t : triangles_) {
            const Vec3d &a = positions_[t[0]], &b = positions_[t[1]], &c = positions_[t[2]];
            const double area = (b - a).cross(c - a).norm() + 1e-12;
            for (const uint32_t v : t) {
                sums[v] += area * (a + b + c) / 3;
                weights[v] += area;
            }
        }
        for (size_t v = solid_.tips().size(); v < positions_.size(); ++v)
            positions_[v] = solid_.project(sums[v] / weights[v]);
    }

    /// Edges whose two opposite angles exceed 180 degrees together flip, where the surface stays a surface.
    void flip() {
        std::unordered_map<uint64_t, uint32_t> face_of;  // directed edge -> triangle
        face_of.reserve(3 * triangles_.size());
        for (uint32_t t = 0; t < triangles_.size(); ++t)
            for (size_t k = 0; k < 3; ++k) face_of[key(triangles_[t][k], triangles_[t][(k + 1) % 3])] = t;
        std::vector<uint8_t> valence(positions_.size(), 0);
        for (const auto& t : triangles_)
            for (const uint32_t v : t) ++valence[v];

        for (uint32_t t = 0; t < triangles_.size(); ++t) {
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3], c = triangles_[t][(k + 2) % 3];
                const uint32_t u = face_of.at(key(b, a));
                const uint32_t d = other(triangles_[u], a, b);
                if (valence[a] <= 4 || valence[b] <= 4 || face_of.contains(key(c, d)) || face_of.contains(key(d, c)))
                    continue;
                if (cotangent(c, a, b) + cotangent(d, a, b) >= -1e-9) continue;  // angles below 180 degrees together
                const Vec3d before = normal(a, b, c) + normal(b, a, d);
                if (normal(c, d, b).dot(before) <= 0 || normal(d, c, a).dot(before) <= 0) continue;  // folds over
                for (const uint64_t old : {key(a, b), key(b, a)}) face_of.erase(old);
                triangles_[t] = {c, d, b};
                triangles_[u] = {d, c, a};
                for (const uint32_t f : {t, u})
                    for (size_t e = 0; e < 3; ++e) face_of[key(triangles_[f][e], triangles_[f][(e + 1) % 3])] = f;
                --valence[a], --valence[b], ++valence[c], ++valence[d];
                break;
            }
        }
    }

    Mesh mesh() const {
        Mesh m;
        m.triangles = triangles_;
        for (const Vec3d& p : positions_) m.positions.push_back(p.cast<float>());
        return m;
    }

private:
    static uint64_t key(uint32_t a, uint32_t b) { return uint64_t(a) << 32 | b; }
    static uint32_t other(const std::array<uint32_t, 3>& t, uint32_t a, uint32_t b) {
        for (const uint32_t v : t)
            if (v != a && v != b) return v;
        return a;
    }
    /// Cotangent at the corner v opposite to the edge: cot c + cot d < 0 is c + d > 180 degrees.
    double cotangent(uint32_t v, uint32_t a, uint32_t b) const {
        const Vec3d x = positions_[a] - positions_[v], y = positions_[b] - positions_[v];
        return x.dot(y) / std::max(x.cross(y).norm(), 1e-12);
    }
    Vec3d normal(uint32_t a, uint32_t b, uint32_t c) const {
        return (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]);
    }

    const Solid& solid_;
    std::vector<Vec3d> positions_;
    std::vector<std::array<uint32_t, 3>> triangles_;
};

/// `count` of the points: the first `given`, then each the farthest from those chosen before. Spaced evenly, whatever
/// the points' density.
std::vector<size_t> spread(const std::vector<Vec3d>& points, size_t given, size_t count) {
    std::vector<size_t> chosen;
    std::vector<double> distance2(points.size(), 1e30);
    size_t next = 0;
    while (chosen.size() < count) {
        chosen.push_back(next);
        size_t farthest = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            distance2[i] = std::min(distance2[i], (points[i] - points[next]).squaredNorm());
            if (distance2[i] > distance2[farthest]) farthest = i;
        }
        next = chosen.size() < given ? chosen.size() : farthest;
    }
    return chosen;
}

}  // namespace

Mesh wrap_solid(const Solid& solid, const Vec3d& center, int triangles) {
    if (triangles < 8 || triangles % 2 != 0) throw std::logic_error("a closed mesh has an even number of triangles");
    const auto count = size_t(triangles / 2 + 2);
    constexpr int oversampling = 6;
    std::vector<Vec3d> directions;
    for (const Vec3d& tip : solid.tips()) directions.push_back((tip - center).normalized());
    for (const Vec3d& d : sphere_directions(oversampling * int(count))) directions.push_back(d);
    std::vector<Vec3d> surface(directions.size());
    for (size_t i = 0; i < surface.size(); ++i) surface[i] = solid.outermost(center, directions[i]);

    std::vector<Vec3d> chosen_directions, positions;
    for (const size_t i : spread(surface, solid.tips().size(), count)) {
        chosen_directions.push_back(directions[i]);
        positions.push_back(surface[i]);
    }
    Wrap wrap(solid, positions, sphere_hull(chosen_directions));
    constexpr int rounds = 60;  // angles and areas improve little after that
    for (int i = 0; i < rounds; ++i) {
        wrap.flip();
        wrap.relax();
    }
    for (int i = 0; i < 3; ++i) wrap.flip();
    return wrap.mesh();
}

}  // namespace radiafit
