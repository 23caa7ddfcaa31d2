#include "capture/agreement.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/parallel.h"

namespace radiafit::tools {
namespace {

constexpr double least_cosine = 0.3;      // of the angle to the normal: beyond, a pixel spans too much surface
constexpr double depth_tolerance = 2e-2;  // relative; small views have large pixels
constexpr uint64_t least_points = 30;     // of a pair; fewer say nothing
constexpr double noise = 2.0 / 255;       // standard deviation of what may be no texture
constexpr double worth_a_fit = 0.02;      // of an image's pixels

}  // namespace

std::vector<ColourSample> observe(std::span<const SurfacePoint> points, const SmallView& view,
                                  const Rasterizer& raster) {
    const Camera& camera = view.camera;
    const Vec3d eye = camera.center();
    std::vector<ColourSample> samples;
    for (uint32_t p = 0; p < points.size(); ++p) {
        const SurfacePoint& point = points[p];
        if ((eye - point.position).normalized().dot(point.normal) < least_cosine) continue;
        const Vec3d at = camera.project(point.position);
        if (!(at.z() > 0 && at.x() >= 1 && at.y() >= 1 && at.x() < camera.width - 1 && at.y() < camera.height - 1))
            continue;
        const size_t pixel = size_t(at.y()) * size_t(camera.width) + size_t(at.x());
        if (!view.mask.empty() && !view.mask[pixel]) continue;
        if (!(std::abs(double(raster.inverse_depth()[pixel]) * at.z() - 1) < depth_tolerance)) continue;
        // Between the four pixels around it.
        const auto x0 = static_cast<int>(at.x() - 0.5), y0 = static_cast<int>(at.y() - 0.5);
        const auto fx = static_cast<float>(at.x() - 0.5 - x0), fy = static_cast<float>(at.y() - 0.5 - y0);
        const float* corner = view.rgb.data() + (size_t(y0) * size_t(camera.width) + size_t(x0)) * 3;
        const size_t row = size_t(camera.width) * 3;
        ColourSample sample{p, {}};
        for (size_t c = 0; c < 3; ++c)
            sample.rgb[c] = (1 - fy) * ((1 - fx) * corner[c] + fx * corner[3 + c]) +
                            fy * ((1 - fx) * corner[row + c] + fx * corner[row + 3 + c]);
        samples.push_back(sample);
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

SharedColours compare(std::span<const ColourSample> a, std::span<const ColourSample> b) {
    SharedColours shared;
    std::array<double, 3> sum_a{}, sum_b{}, squares{}, products{};
    for (size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        if (a[i].point < b[j].point) {
            ++i;
        } else if (b[j].point < a[i].point) {
            ++j;
        } else {
            for (size_t c = 0; c < 3; ++c) {
                const double x = a[i].rgb[c], y = b[j].rgb[c];
                sum_a[c] += x, sum_b[c] += y;
                squares[c] += 0.5 * (x * x + y * y);
                products[c] += x * y;
                shared.difference += std::abs(x - y) / 3;
            }
            ++shared.points, ++i, ++j;
        }
    }
    if (shared.points < least_points) return {};
    shared.pairs = 1;
    const auto count = double(shared.points);
    for (size_t c = 0; c < 3; ++c) {
        shared.covariance += products[c] - sum_a[c] * sum_b[c] / count;
        shared.variance += squares[c] - 0.5 * (sum_a[c] * sum_a[c] + sum_b[c] * sum_b[c]) / count;
    }
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

double Agreement::value(bool masked) const {
    return (masked ? coverage.overlap() : seeing) + std::max(0.0, colours.correlation());
}

Agreement measure_agreement(const Mesh& mesh, std::span<const SurfacePoint> points, std::span<const SmallView> views,
                            const Pairs& pairs) {
    std::vector<Rasterizer> rasters(static_cast<size_t>(thread_count()));
    std::vector<std::vector<ColourSample>> samples(views.size());
    std::vector<Coverage> counts(views.size());
    parallel_for(views.size(), 1, [&](size_t i, int worker) {
        Rasterizer& raster = rasters[size_t(worker)];
        raster.draw(mesh, views[i].camera);
        counts[i] = count_pixels(raster, views[i].mask);
        samples[i] = observe(points, views[i], raster);
    });
    Agreement result;
    for (const Coverage& c : counts) {
        result.coverage += c;
        result.seeing += c.share() > worth_a_fit;
    }
    result.seeing /= double(views.size());
    for (const auto& [a, b] : pairs) result.colours += compare(samples[a], samples[b]);
    // Few pairs that happen to agree are no evidence.
    if (2 * result.colours.pairs < pairs.size())
        result.colours.covariance *= 2 * double(result.colours.pairs) / double(std::max<size_t>(pairs.size(), 1));
    return result;
}

bool has_masks(std::span<const SmallView> views) {
    return std::ranges::any_of(views, [](const SmallView& view) { return !view.mask.empty(); });
}

}  // namespace radiafit::tools
