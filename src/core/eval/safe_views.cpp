#include "eval/safe_views.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "eval/seen_by.h"
#include "geometry/direction_hull.h"

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

}  // namespace

SafeViews::SafeViews(const Dataset& dataset, const std::vector<uint32_t>& training,
                     std::shared_ptr<const TriangleAtlas> atlas, SurfaceLookup lookup, Contestant fit)
    : dataset_(&dataset),
      atlas_(std::move(atlas)),
      lookup_(*atlas_, lookup),
      fit_(std::move(fit)),
      of_triangle_(views_that_see(dataset, ImageStream(dataset, StreamSource::disk), training)),
      of_vertex_(dataset.mesh.vertex_count()),
      shares_(size_t(thread_count())),
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

float SafeViews::share_at(uint32_t vertex, const Vec3d& eye) const {
    const std::vector<uint32_t>& views = of_vertex_[vertex];
    if (views.empty()) return 1;
    const Vec3d place = dataset_->mesh.positions[vertex].cast<double>();
    const Vec3d direction = (eye - place).normalized();
    double nearest = -1;  // cosine
    std::vector<Vec3d> directions;
    directions.reserve(views.size());
    for (const uint32_t v : views) {
        directions.push_back(dataset_->views[v].direction_to_camera(place));
        nearest = std::max(nearest, directions.back().dot(direction));
    }
    const double angle = std::acos(std::clamp(nearest, -1.0, 1.0));
    if (angle <= trusted) return 1;
    const double beyond = std::max(angle - apart, angle_outside(directions, direction) - trusted);
    return float(std::clamp(1 - beyond / fade, 0.0, 1.0));
}

double SafeViews::share_of_fit(const Vec3d& eye) const {
    double sum = 0, weights = 0;
    const Mesh& mesh = dataset_->mesh;
    std::vector<float> at(mesh.vertex_count(), -1.0f);
    const auto share = [&](uint32_t v) {
        if (at[v] < 0) at[v] = share_at(v, eye);
        return double(at[v]);
    };
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (of_triangle_[t].empty()) continue;
        const auto& [a, b, c] = mesh.triangles[t];
        const Vec3d p = mesh.positions[a].cast<double>(), q = mesh.positions[b].cast<double>(),
                    r = mesh.positions[c].cast<double>();
        const double facing = (q - p).cross(r - p).dot((eye - p).normalized());
        if (!(facing > 0)) continue;
        sum += facing * (share(a) + share(b) + share(c)) / 3;
        weights += facing;
    }
    return weights > 0 ? sum / weights : 1;
}

void SafeViews::find_bounds(const std::vector<uint32_t>& triangles, int worker) const {
    const uint32_t each = atlas_->texels_per_tile();
    std::vector<Bounds> found(triangles.size() * each);
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
        size_t at = 0;
        for (const uint32_t i : shown_to[v]) {
            const auto& [a, b, c] = dataset_->mesh.triangles[triangles[i]];
            const auto& p = dataset_->mesh.positions;
            const Vec3f normal = (p[b] - p[a]).cross(p[c] - p[a]).normalized();
            const float weight = std::max(0.1f, normal.dot((eye - p[a]).normalized()));
            weights[i] += weight;
            for (uint32_t local = 0; local < atlas_->tile(triangles[i]).texels(); ++local, ++at) {
                const Vec3f colour = Vec3f::Map(&rgb[3 * at]);
                Bounds& of = found[i * each + local];
                of.mean += weight * colour;
                of.brightest = of.brightest.cwiseMax(colour);
            }
        }
    }
    const std::lock_guard lock(finding_);
    for (size_t i = 0; i < triangles.size(); ++i) {
        if (known_[triangles[i]].load(std::memory_order_relaxed)) continue;
        for (uint32_t local = 0; local < each; ++local) {
            Bounds& to = bounds_[size_t(triangles[i]) * each + local];
            to = found[i * each + local];
            if (weights[i] > 0) to.mean /= weights[i];
        }
        known_[triangles[i]].store(1, std::memory_order_release);
    }
}

void SafeViews::shade(const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb,
                      int worker) const {
    fit_.shade(view, pixels, rgb, worker);
    Shares& shares = shares_.at(size_t(worker));
    const Vec3d eye = view.camera.center();
    if (shares.at.empty() || shares.eye != eye) {
        shares.eye = eye;
        shares.at.assign(dataset_->mesh.vertex_count(), -1.0f);
    }
    const auto share_of = [&](uint32_t vertex) {
        float& share = shares.at[vertex];
        if (share < 0) share = share_at(vertex, eye);
        return share;
    };
    struct Faded {
        size_t pixel;
        float share;
        TexelMix mix;
    };
    std::vector<Faded> faded;
    std::vector<uint32_t> unknown;
    for (size_t i = 0; i < pixels.size(); ++i) {
        const RasterPixel& p = pixels[i];
        if (p.triangle == no_triangle || of_triangle_[p.triangle].empty()) continue;
        const auto& [a, b, c] = dataset_->mesh.triangles[p.triangle];
        const float share = (1 - p.b1 - p.b2) * share_of(a) + p.b1 * share_of(b) + p.b2 * share_of(c);
        if (share >= 1) continue;
        faded.push_back({i, share, lookup_.at(p.triangle, p.b1, p.b2)});
        for (const TexelMix::Entry& entry : faded.back().mix.entries())
            if (!known_[entry.triangle].load(std::memory_order_acquire)) unknown.push_back(entry.triangle);
    }
    if (faded.empty()) return;
    make_unique(unknown);
    if (!unknown.empty()) find_bounds(unknown, worker);
    for (const auto& [pixel, share, mix] : faded) {
        Bounds here;
        float weight = 0;
        for (const auto& [triangle, local, of] : mix.entries()) {
            if (of_triangle_[triangle].empty()) continue;
            const Bounds& bounds = bounds_[size_t(triangle) * atlas_->texels_per_tile() + local];
            here.mean += of * bounds.mean;
            here.brightest += of * bounds.brightest;
            weight += of;
        }
        auto colour = Vec3f::Map(&rgb[3 * pixel]);
        const Vec3f bounded = colour.cwiseMin(most / weight * here.brightest);
        colour = share * (share * colour + (1 - share) * bounded) + (1 - share) / weight * here.mean;
    }
}

Contestant safe_contestant_of(const Dataset& dataset, const std::vector<uint32_t>& training,
                              std::shared_ptr<const TriangleAtlas> atlas, SurfaceLookup lookup, Contestant fit) {
    Contestant out;
    out.space = fit.space;
    out.error_bars = fit.error_bars;
    const auto safe = std::make_shared<const SafeViews>(dataset, training, std::move(atlas), lookup, std::move(fit));
    out.shade = [safe](const View& view, const auto& pixels, std::vector<float>& rgb, int worker) {
        safe->shade(view, pixels, rgb, worker);
    };
    out.share_of_fit = [safe](const View& view) { return safe->share_of_fit(view.camera.center()); };
    return out;
}

}  // namespace radiafit
