#include "eval/safe_views.h"

#include <algorithm>
#include <cmath>
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

void add_to(std::vector<uint32_t>& set, const std::vector<uint32_t>& others) {
    set.insert(set.end(), others.begin(), others.end());
}

void make_unique(std::vector<uint32_t>& set) {
    std::ranges::sort(set);
    set.erase(std::unique(set.begin(), set.end()), set.end());
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
      of_triangle_(views_that_see(dataset, ImageStream(dataset, StreamSource::disk), training)),
      of_vertex_(dataset.mesh.vertex_count()),
      angles_(size_t(thread_count())),
      bounds_(atlas_->texel_count()),
      known_(dataset.mesh.triangle_count()) {
    const auto& triangles = dataset.mesh.triangles;
    for (size_t t = 0; t < triangles.size(); ++t)
        for (const uint32_t v : triangles[t]) add_to(of_vertex_[v], of_triangle_[t]);
    for (auto& of : of_vertex_) make_unique(of);
    // Between the centres of pixels triangles may be missed that their neighbours' photographs show as well.
    for (size_t t = 0; t < triangles.size(); ++t) {
        if (!of_triangle_[t].empty()) continue;
        for (const uint32_t v : triangles[t]) add_to(of_triangle_[t], of_vertex_[v]);
        make_unique(of_triangle_[t]);
    }
}

float SafeViews::share_at(float angle) { return std::clamp(1 - (angle - float(apart)) / float(fade), 0.0f, 1.0f); }

float SafeViews::angle_at(uint32_t vertex, const Vec3d& eye) const {
    const Vec3d place = dataset_->mesh.positions[vertex].cast<double>();
    const Vec3d direction = (eye - place).normalized();
    double nearest = of_vertex_[vertex].empty() ? 1 : -1;  // cosine
    for (const uint32_t v : of_vertex_[vertex])
        nearest = std::max(nearest, dataset_->views[v].direction_to_camera(place).dot(direction));
    return float(std::acos(std::clamp(nearest, -1.0, 1.0)));
}

double SafeViews::share_of_fit(const Vec3d& eye) const {
    double sum = 0, weights = 0;
    const Mesh& mesh = dataset_->mesh;
    std::vector<float> at(mesh.vertex_count(), -1.0f);
    const auto share = [&](uint32_t v) {
        if (at[v] < 0) at[v] = share_at(angle_at(v, eye));
        return double(at[v]);
    };
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (of_triangle_[t].empty()) continue;
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
        for (const uint32_t v : some_of(of_triangle_[triangles[i]], most_views)) shown_to[v].push_back(uint32_t(i));
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
        if (p.triangle == no_triangle || of_triangle_[p.triangle].empty()) continue;
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
            if (of_triangle_[triangle].empty()) continue;
            const Bounds& texel = bounds_[size_t(triangle) * atlas_->texels_per_tile() + local];
            here.mean += share * texel.mean;
            here.reach += share * texel.reach;
            weight += share;
        }
        const Vec3f mean = here.mean / weight, reach = most / weight * here.reach;
        auto colour = Vec3f::Map(&rgb[3 * pixel]);
        const Vec3f within = colour.cwiseMin(mean + reach).cwiseMax(mean - reach);
        const float held = std::min(1.0f, (angle - float(bound_from)) / float(bound_within)), share = share_at(angle);
        colour = share * (colour + held * (within - colour)) + (1 - share) * mean;
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
