#include "stereo/source_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace radiafit::tools {
namespace {

constexpr uint32_t least_shared = 10;                                  // points
constexpr double best_angle = 8, spread_below = 4, spread_above = 15;  // degrees

double weight_of(const Vec3d& to_first, const Vec3d& to_second) {
    const double angle = std::acos(std::clamp(to_first.dot(to_second), -1.0, 1.0)) * 180 / std::numbers::pi;
    const double away = (angle - best_angle) / (angle < best_angle ? spread_below : spread_above);
    return std::exp(-0.5 * away * away);
}

}  // namespace

std::vector<std::vector<uint32_t>> choose_sources(std::span<const Camera> cameras, std::span<const SparsePoint> points,
                                                  size_t most) {
    const size_t count = cameras.size();
    std::vector<Vec3d> centres;
    for (const Camera& camera : cameras) centres.push_back(camera.center());
    std::vector<double> score(count * count, 0);
    std::vector<uint32_t> shared(count * count, 0);
    std::vector<Vec3d> to_camera;
    for (const SparsePoint& point : points) {
        to_camera.clear();
        for (const uint32_t i : point.images) to_camera.push_back((centres[i] - point.position).normalized());
        for (size_t a = 0; a < point.images.size(); ++a)
            for (size_t b = 0; b < a; ++b) {
                const size_t pair = point.images[a] * count + point.images[b];
                score[pair] += weight_of(to_camera[a], to_camera[b]);
                ++shared[pair];
            }
    }
    std::vector<std::vector<uint32_t>> sources(count);
    for (size_t i = 0; i < count; ++i) {
        const auto pair = [&](size_t j) { return std::max(i, j) * count + std::min(i, j); };
        for (size_t j = 0; j < count; ++j)
            if (j != i && shared[pair(j)] >= least_shared) sources[i].push_back(uint32_t(j));
        std::stable_sort(sources[i].begin(), sources[i].end(),
                         [&](uint32_t a, uint32_t b) { return score[pair(a)] > score[pair(b)]; });
        if (sources[i].size() > most) sources[i].resize(most);
    }
    return sources;
}

}  // namespace radiafit::tools
