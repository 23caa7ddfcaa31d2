#include "capture/mesh_agreement.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/parallel.h"

namespace radiafit::tools {
namespace {

constexpr double depth_tolerance = 2e-2;  // relative; small views have large pixels
constexpr uint64_t least_points = 30;     // of a pair; fewer say nothing
constexpr double noise = 2.0 / 255;       // standard deviation of what may be no texture
constexpr double worth_a_fit = 0.02;      // of an image's pixels

}  // namespace

std::vector<ColourSample> observe(std::span<const SurfacePoint> points, const SmallView& view,
                                  const Rasterizer* raster) {
    const Camera& camera = view.camera;
    const Vec3d eye = camera.center();
    std::vector<ColourSample> samples;
    for (uint32_t p = 0; p < points.size(); ++p) {
        const std::optional<Vec3d> seen = project_facing(points[p], camera, eye);
        if (!seen) continue;
        const Vec3d& at = *seen;
        const size_t pixel = size_t(at.y()) * size_t(camera.width) + size_t(at.x());
        if (!view.mask.empty() && !view.mask[pixel]) continue;
        if (raster && !(std::abs(double(raster->inverse_depth()[pixel]) * at.z() - 1) < depth_tolerance)) continue;
        // Between the four pixels around it.
        const auto x0 = static_cast<int>(at.x() - 0.5), y0 = static_cast<int>(at.y() - 0.5);
        const auto fx = static_cast<float>(at.x() - 0.5 - x0), fy = static_cast<float>(at.y() - 0.5 - y0);
        const float* corner = view.rgb.data() + (size_t(y0) * size_t(camera.width) + size_t(x0)) * 3;
        const size_t row = size_t(camera.width) * 3;
        ColourSample sample{p, {}};
        for (size_t c = 0; c < 3; ++c)
            sample.rgb[c] = (1 - fy) * ((1 - fx) * corner[c] + fx * corner[3 + c]) +
                            fy * ((1 - fx) * corner[row + c] + fx * corner[row + 3 + c]);
        if (std::isfinite(sample.rgb[0] + sample.rgb[1] + sample.rgb[2])) samples.push_back(sample);
    }
    return samples;
}

double SharedColours::correlation() const {
    return points ? covariance / (variance + 3 * noise * noise * double(points)) : 0;
}

SharedColours& SharedColours::operator+=(const SharedColours& other) {
    points += other.points, pairs += other.pairs;
    covariance += other.covariance, variance += other.variance, difference += other.difference;
    return *this;
}

bool SharedColours::vary() const { return variance > 3 * 4 * noise * noise * double(points); }

SharedColours compare(std::span<const ColourSample> a, std::span<const ColourSample> b) {
    SharedColours shared;
    struct Sums {
        double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    };
    std::array<Sums, 3> sums{};
    for (size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        if (a[i].point < b[j].point) {
            ++i;
        } else if (b[j].point < a[i].point) {
            ++j;
        } else {
            for (size_t c = 0; c < 3; ++c) {
                const double x = a[i].rgb[c], y = b[j].rgb[c];
                Sums& s = sums[c];
                s.a += x, s.b += y, s.aa += x * x, s.bb += y * y, s.ab += x * y;
                shared.difference += std::abs(x - y) / 3;
            }
            ++shared.points, ++i, ++j;
        }
    }
    if (shared.points < least_points) return {};
    shared.pairs = 1;
    const auto count = double(shared.points);
    double variance_a = 0, variance_b = 0;
    for (const Sums& s : sums) {
        shared.covariance += s.ab - s.a * s.b / count;
        variance_a += s.aa - s.a * s.a / count;
        variance_b += s.bb - s.b * s.b / count;
    }
    shared.variance = std::sqrt(std::max(variance_a, 0.0) * std::max(variance_b, 0.0));
    return shared;
}

Pairs neighbour_pairs(std::span<const SmallView> views, const Vec3d& centre, size_t neighbours) {
    constexpr double least_cosine_between = 0.5;
    std::vector<Vec3d> directions;
    for (const SmallView& view : views) directions.push_back((view.camera.center() - centre).normalized());
    std::set<std::pair<size_t, size_t>> pairs;
    std::vector<size_t> order(views.size());
    for (size_t i = 0; i < views.size(); ++i) {
        std::iota(order.begin(), order.end(), size_t(0));
        const size_t count = std::min(neighbours + 1, order.size());
        std::ranges::partial_sort(order, order.begin() + ptrdiff_t(count), std::greater<>(),
                                  [&](size_t j) { return j == i ? 2 : directions[i].dot(directions[j]); });
        for (size_t k = 1; k < count; ++k)  // the first is the view itself
            if (directions[i].dot(directions[order[k]]) >= least_cosine_between) pairs.insert(std::minmax(i, order[k]));
    }
    return {pairs.begin(), pairs.end()};
}

double MeshAgreement::value(bool masked) const {
    return (masked ? coverage.overlap() : seeing) + std::max(0.0, colours.correlation());
}

namespace {

/// What the views' samples share, of all pairs.
SharedColours compare_pairs(const std::vector<std::vector<ColourSample>>& samples, const Pairs& pairs) {
    SharedColours sum;
    for (const auto& [a, b] : pairs) sum += compare(samples[a], samples[b]);
    // Few pairs that happen to agree are no evidence.
    if (2 * sum.pairs < pairs.size())
        sum.covariance *= 2 * double(sum.pairs) / double(std::max<size_t>(pairs.size(), 1));
    return sum;
}

}  // namespace

MeshAgreement measure_agreement(const Mesh& mesh, std::span<const SurfacePoint> points,
                                std::span<const SmallView> views, const Pairs& pairs) {
    std::vector<Rasterizer> rasters(static_cast<size_t>(thread_count()));
    std::vector<std::vector<ColourSample>> samples(views.size());
    std::vector<Coverage> counts(views.size());
    parallel_for(views.size(), 1, [&](size_t i, int worker) {
        Rasterizer& raster = rasters[size_t(worker)];
        raster.draw(mesh, views[i].camera);
        counts[i] = count_pixels(raster, views[i].mask);
        samples[i] = observe(points, views[i], &raster);
    });
    MeshAgreement result;
    for (const Coverage& c : counts) {
        result.coverage += c;
        result.seeing += c.share() > worth_a_fit;
    }
    result.seeing /= double(views.size());
    result.colours = compare_pairs(samples, pairs);
    return result;
}

double guess_agreement(std::span<const SurfacePoint> points, std::span<const SmallView> views, const Pairs& pairs) {
    std::vector<std::vector<ColourSample>> samples(views.size());
    std::vector<size_t> facing(views.size());
    parallel_for(views.size(), 1, [&](size_t i, int) {
        samples[i] = observe(points, views[i], nullptr);
        const Vec3d eye = views[i].camera.center();
        for (const SurfacePoint& point : points) facing[i] += faces(point, eye);
    });
    double inside = 0, all = 0;
    for (size_t i = 0; i < views.size(); ++i) inside += double(samples[i].size()), all += double(facing[i]);
    return (all > 0 ? inside / all : 0) + std::max(0.0, compare_pairs(samples, pairs).correlation());
}

bool has_masks(std::span<const SmallView> views) {
    return std::ranges::any_of(views, [](const SmallView& view) { return !view.mask.empty(); });
}

}  // namespace radiafit::tools
