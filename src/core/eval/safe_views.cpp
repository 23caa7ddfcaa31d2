#include "eval/safe_views.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "eval/seen_by.h"

namespace radiafit {
namespace {

/// So many of these, evenly spread.
std::vector<uint32_t> some_of(const std::vector<uint32_t>& views, size_t most) {
    if (views.size() <= most) return views;
    std::vector<uint32_t> out;
    for (size_t i = 0; i < most; ++i) out.push_back(views[i * views.size() / most]);
    return out;
}

void make_unique(std::vector<uint32_t>& set) {
    std::ranges::sort(set);
    set.erase(std::unique(set.begin(), set.end()), set.end());
}

std::vector<Vec3d> directions_from(const Dataset& dataset, uint32_t vertex, const std::vector<uint32_t>& views) {
    const Vec3d place = dataset.mesh.positions[vertex].cast<double>();
    std::vector<Vec3d> out;
    for (const uint32_t v : views) out.push_back(dataset.views[v].direction_to_camera(place));
    return out;
}

/// Radians from a direction to the next one, on average; 0 of fewer than two.
double mean_apart(const std::vector<Vec3d>& directions) {
    if (directions.size() < 2) return 0;
    double sum = 0;
    for (size_t i = 0; i < directions.size(); ++i) {
        double nearest = -1;  // cosine
        for (size_t j = 0; j < directions.size(); ++j)
            if (j != i) nearest = std::max(nearest, directions[i].dot(directions[j]));
        sum += std::acos(std::clamp(nearest, -1.0, 1.0));
    }
    return sum / double(directions.size());
}

Vec3f twice_area(const Mesh& mesh, uint32_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    return (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]);
}

/// The cosine at a triangle's first vertex between its normal and the direction to the eye.
float facing(const Mesh& mesh, uint32_t triangle, const Vec3f& eye) {
    const Vec3f normal = twice_area(mesh, triangle).normalized();
    return normal.dot((eye - mesh.positions[mesh.triangles[triangle][0]]).normalized());
}

}  // namespace

SafeViews::SafeViews(const Dataset& dataset, const std::vector<uint32_t>& training,
                     std::shared_ptr<const TriangleAtlas> atlas, SurfaceLookup lookup, Contestant fit)
    : dataset_(&dataset),
      atlas_(std::move(atlas)),
      lookup_(*atlas_, lookup),
      fit_(std::move(fit)),
      of_vertex_(views_that_see_vertices(dataset, ImageStream(dataset, StreamSource::disk), training)),
      spacings_(dataset.mesh.vertex_count(), 1.0f),
      angles_(size_t(thread_count())),
      bounds_(atlas_->texel_count()),
      known_(dataset.mesh.triangle_count()) {
    constexpr size_t grain = 64;
    parallel_for(of_vertex_.size(), grain, [&](size_t v, int) {
        spacings_[v] = std::max(1.0f, float(mean_apart(directions_from(dataset, uint32_t(v), of_vertex_[v])) / dense));
    });
}

/// Those that show all of its vertices, or else any of them.
std::vector<uint32_t> SafeViews::views_of(uint32_t triangle) const {
    const auto& [a, b, c] = dataset_->mesh.triangles[triangle];
    std::vector<uint32_t> two, all;
    std::ranges::set_intersection(of_vertex_[a], of_vertex_[b], std::back_inserter(two));
    std::ranges::set_intersection(two, of_vertex_[c], std::back_inserter(all));
    if (!all.empty()) return all;
    for (const uint32_t v : {a, b, c}) all.insert(all.end(), of_vertex_[v].begin(), of_vertex_[v].end());
    make_unique(all);
    return all;
}

bool SafeViews::is_seen(uint32_t triangle) const {
    return std::ranges::any_of(dataset_->mesh.triangles[triangle], [&](uint32_t v) { return !of_vertex_[v].empty(); });
}

float SafeViews::share_at(float angle) { return std::clamp(1 - (angle - float(apart)) / float(fade), 0.0f, 1.0f); }

float SafeViews::angle_at(uint32_t vertex, const Vec3d& eye) const {
    const Vec3d place = dataset_->mesh.positions[vertex].cast<double>();
    const Vec3d direction = (eye - place).normalized();
    double nearest = of_vertex_[vertex].empty() ? 1 : -1;  // cosine
    for (const uint32_t v : of_vertex_[vertex])
        nearest = std::max(nearest, dataset_->views[v].direction_to_camera(place).dot(direction));
    return float(std::acos(std::clamp(nearest, -1.0, 1.0))) / spacings_[vertex];
}

double SafeViews::share_of_fit(const Vec3d& eye) const {
    double sum = 0, weights = 0;
    const Mesh& mesh = dataset_->mesh;
    std::vector<float> at(mesh.vertex_count(), -1.0f);
    const auto share = [&](uint32_t v) {
        if (at[v] < 0) at[v] = share_at(angle_at(v, eye));
        return double(at[v]);
    };
    constexpr size_t most_triangles = 4000;  // looked at
    const size_t step = std::max<size_t>(1, mesh.triangles.size() / most_triangles);
    for (size_t t = 0; t < mesh.triangles.size(); t += step) {
        if (!is_seen(uint32_t(t))) continue;
        const auto& [a, b, c] = mesh.triangles[t];
        const double area = double(twice_area(mesh, uint32_t(t)).norm()) * facing(mesh, uint32_t(t), eye.cast<float>());
        if (!(area > 0)) continue;
        sum += area * (share(a) + share(b) + share(c)) / 3;
        weights += area;
    }
    return weights > 0 ? sum / weights : 1;
}

void SafeViews::find_bounds(std::span<const uint32_t> triangles, int worker) const {
    struct Seen {
        Vec3f sum = Vec3f::Zero(), brightest = Vec3f::Constant(-std::numeric_limits<float>::infinity()),
              darkest = Vec3f::Constant(std::numeric_limits<float>::infinity());
    };
    const uint32_t each = atlas_->texels_per_tile();
    std::vector<Seen> seen(triangles.size() * each);
    std::vector<float> weights(triangles.size(), 0.0f);
    std::vector<std::vector<uint32_t>> shown_to(dataset_->views.size());  // places in `triangles`
    for (size_t i = 0; i < triangles.size(); ++i)
        for (const uint32_t v : some_of(views_of(triangles[i]), most_views)) shown_to[v].push_back(uint32_t(i));
    std::vector<RasterPixel> centres;
    std::vector<float> rgb;
    for (size_t v = 0; v < shown_to.size(); ++v) {
        if (shown_to[v].empty()) continue;
        centres.clear();
        for (const uint32_t i : shown_to[v]) {
            const TriangleTile& tile = atlas_->tile(triangles[i]);
            for (uint32_t local = 0; local < tile.texels(); ++local)
                centres.push_back({triangles[i], tile.barycentric(local)[1], tile.barycentric(local)[2]});
        }
        fit_.shade(dataset_->views[v], centres, rgb, worker);
        const Vec3f eye = dataset_->views[v].camera.center().cast<float>();
        const float* colour = rgb.data();
        for (const uint32_t i : shown_to[v]) {
            const float weight = std::max(0.1f, facing(dataset_->mesh, triangles[i], eye));
            weights[i] += weight;
            for (uint32_t local = 0; local < atlas_->tile(triangles[i]).texels(); ++local, colour += 3) {
                Seen& texel = seen[i * each + local];
                texel.sum += weight * Vec3f::Map(colour);
                texel.brightest = texel.brightest.cwiseMax(Vec3f::Map(colour));
                texel.darkest = texel.darkest.cwiseMin(Vec3f::Map(colour));
            }
        }
    }
    const std::lock_guard lock(finding_);
    for (size_t i = 0; i < triangles.size(); ++i) {
        if (known_[triangles[i]].load(std::memory_order_relaxed)) continue;
        for (uint32_t local = 0; weights[i] > 0 && local < atlas_->tile(triangles[i]).texels(); ++local) {
            const Seen& texel = seen[i * each + local];
            const Vec3f mean = texel.sum / weights[i];
            bounds_[size_t(triangles[i]) * each + local] = {mean,
                                                            (texel.brightest - mean).cwiseMax(mean - texel.darkest)};
        }
        known_[triangles[i]].store(1, std::memory_order_release);
    }
}

const std::vector<SafeViews::Bounds>& SafeViews::all_bounds() const {
    constexpr size_t at_once = 512;
    std::vector<uint32_t> all(known_.size());
    std::iota(all.begin(), all.end(), 0u);
    parallel_chunks(all.size(), at_once, [&](size_t begin, size_t end, int worker) {
        find_bounds(std::span(all).subspan(begin, end - begin), worker);
    });
    return bounds_;
}

void SafeViews::bound(const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb,
                      int worker) const {
    Angles& angles = angles_.at(size_t(worker));
    const Vec3d eye = view.camera.center();
    if (angles.at.empty() || angles.eye != eye) {
        angles.eye = eye;
        angles.at.assign(dataset_->mesh.vertex_count(), -1.0f);
    }
    const auto angle_of = [&](uint32_t vertex) {
        float& angle = angles.at[vertex];
        if (angle < 0) angle = angle_at(vertex, eye);
        return angle;
    };
    struct Bounded {
        size_t pixel;
        float angle;
        TexelMix mix;
    };
    std::vector<Bounded> bounded;
    std::vector<uint32_t> unknown;
    for (size_t i = 0; i < pixels.size(); ++i) {
        const RasterPixel& p = pixels[i];
        if (p.triangle == no_triangle || !is_seen(p.triangle)) continue;
        const auto& [a, b, c] = dataset_->mesh.triangles[p.triangle];
        const float angle = (1 - p.b1 - p.b2) * angle_of(a) + p.b1 * angle_of(b) + p.b2 * angle_of(c);
        if (angle <= float(bound_from)) continue;
        bounded.push_back({i, angle, lookup_.at(p.triangle, p.b1, p.b2)});
        for (const TexelMix::Entry& entry : bounded.back().mix.entries())
            if (!known_[entry.triangle].load(std::memory_order_acquire)) unknown.push_back(entry.triangle);
    }
    make_unique(unknown);
    if (!unknown.empty()) find_bounds(unknown, worker);
    for (const auto& [pixel, angle, mix] : bounded) {
        Bounds here;
        float weight = 0;
        for (const auto& [triangle, local, share] : mix.entries()) {
            if (!is_seen(triangle)) continue;
            const Bounds& texel = bounds_[size_t(triangle) * atlas_->texels_per_tile() + local];
            here.mean += share * texel.mean;
            here.reach += share * texel.reach;
            weight += share;
        }
        const Vec3f mean = here.mean / weight, reach = most / weight * here.reach;
        auto colour = Vec3f::Map(&rgb[3 * pixel]);
        const Vec3f within = colour.cwiseMin(mean + reach).cwiseMax(mean - reach);
        const float held = std::min(1.0f, (angle - float(bound_from)) / float(bound_within)), share = share_at(angle);
        const Vec3f fitted = held < 1 ? Vec3f(colour + held * (within - colour)) : within;
        colour = share > 0 ? Vec3f(share * fitted + (1 - share) * mean) : mean;
    }
}

Contestant safe_contestant_of(std::shared_ptr<const SafeViews> bounds, Contestant shown) {
    Contestant out = shown;
    out.shade = [bounds, shade = std::move(shown.shade)](const View& view, const auto& pixels, std::vector<float>& rgb,
                                                         int worker) {
        shade(view, pixels, rgb, worker);
        bounds->bound(view, pixels, rgb, worker);
    };
    out.share_of_fit = [bounds](const View& view) { return bounds->share_of_fit(view.camera.center()); };
    return out;
}

}  // namespace radiafit
