#include "stereo/patch_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/rng.h"
#include "stereo/patch.h"

namespace radiafit::tools {
namespace {

constexpr int coarsest_side = 200;    // pixels
constexpr int swept_planes = 64;      // of each ray
constexpr float least_facing = 0.2f;  // cosine: surfaces seen more obliquely are left to other photographs
constexpr int coarsest_rounds = 4, rounds = 2;
constexpr size_t most_sources = 16;

/// Random numbers in [-1, 1) of a pixel in a round, a separate sequence for each.
class Dice {
public:
    Dice(uint64_t seed, size_t pixel, int round)
        : seed_(seed), counter_((uint64_t(pixel) * 16 + uint64_t(round)) * 16) {}
    float next() { return 2 * random_uniform(seed_, counter_++) - 1; }

private:
    uint64_t seed_, counter_;
};

/// One size of the pyramid.
class Level {
public:
    Level(const GreyImage& reference, std::vector<const GreyImage*> sources, const SearchBall& region)
        : reference_(&reference), sources_(std::move(sources)), region_(region) {
        for (const GreyImage* source : sources_) pairs_.emplace_back(reference.camera, source->camera);
        const size_t count = reference.values.size();
        planes_.assign(count, InversePlane::Zero());
        costs_.assign(count, worst_cost);
    }

    int width() const { return reference_->camera.width; }
    int height() const { return reference_->camera.height; }
    const std::vector<InversePlane>& planes() const { return planes_; }
    float cost(size_t pixel) const { return costs_[pixel]; }

    void sweep() {
        each_pixel([&](Pixel& p) {
            for (int k = 0; k < swept_planes; ++k) {
                const float share = (float(k) + 0.5f) / swept_planes;
                offer(p, {0, 0, p.range[0] + share * (p.range[1] - p.range[0])});
            }
        });
    }

    /// Begins with what was found at half the size.
    void take_over(const Level& half) {
        each_pixel([&](Pixel& p) {
            const int x = std::min(p.x / 2, half.width() - 1), y = std::min(p.y / 2, half.height() - 1);
            offer(p, half.planes_[size_t(y) * size_t(half.width()) + size_t(x)]);
        });
    }

    /// Two half rounds: pixels of one colour of the checkerboard read those of the other alone. `scale`: of the random
    /// changes, as a share of the region and in units of 90 degrees.
    void improve(int round, float depth_scale, float normal_scale, uint64_t seed) {
        constexpr std::array<std::array<int, 2>, 8> others = {
            {{0, -1}, {-1, 0}, {1, 0}, {0, 1}, {0, -5}, {-5, 0}, {5, 0}, {0, 5}}};
        for (int colour = 0; colour < 2; ++colour)
            each_pixel([&](Pixel& p) {
                if (((p.x + p.y) & 1) != colour) return;
                for (const auto& [dx, dy] : others) {
                    const int x = p.x + dx, y = p.y + dy;
                    if (x >= 0 && y >= 0 && x < width() && y < height())
                        offer(p, planes_[size_t(y) * size_t(width()) + size_t(x)]);
                }
                Dice dice(seed, p.at, round);
                offer(p, changed(p, depth_scale * dice.next(), 0, dice));
                offer(p, changed(p, 0, normal_scale, dice));
                offer(p, changed(p, depth_scale * dice.next(), normal_scale, dice));
            });
    }

private:
    struct Pixel {
        int x, y;
        size_t at;
        Vec3f ray;
        std::array<float, 2> range;  ///< of 1/z
        Patch patch;
    };

    template <class Do>
    void each_pixel(const Do& act) {
        Pixel p;
        for (p.y = 0; p.y < height(); ++p.y)
            for (p.x = 0; p.x < width(); ++p.x) {
                const auto range = inverse_depths(region_, reference_->camera, p.x + 0.5, p.y + 0.5);
                if (!range || !p.patch.take(*reference_, p.x, p.y)) continue;
                p.at = size_t(p.y) * size_t(width()) + size_t(p.x);
                p.ray = ray_of(reference_->camera, p.x + 0.5, p.y + 0.5);
                p.range = *range;
                act(p);
            }
    }

    /// The pixel's plane is `plane` from now on if it costs less.
    void offer(const Pixel& p, const InversePlane& plane) {
        const float inverse_depth = plane.dot(p.ray);
        if (!(inverse_depth >= p.range[0] && inverse_depth <= p.range[1]) || facing(plane, p.ray) < least_facing)
            return;
        std::array<float, most_sources> costs;
        const size_t count = pairs_.size();
        for (size_t s = 0; s < count; ++s) costs[s] = p.patch.cost(*sources_[s], pairs_[s].map(plane, p.ray));
        const size_t taken = std::max<size_t>((count + 1) / 2, std::min<size_t>(2, count));
        std::partial_sort(costs.begin(), costs.begin() + ptrdiff_t(taken), costs.begin() + ptrdiff_t(count));
        float mean = 0;
        for (size_t s = 0; s < taken; ++s) mean += costs[s] / float(taken);
        if (mean < costs_[p.at]) {
            costs_[p.at] = mean;
            planes_[p.at] = plane;
        }
    }

    /// The pixel's plane, nearer or farther, and tilted; zero, which offer() refuses, where it has none yet.
    InversePlane changed(const Pixel& p, float nearer, float tilt, Dice& dice) const {
        const InversePlane& plane = planes_[p.at];
        if (plane == InversePlane::Zero()) return plane;
        const float inverse_depth = plane.dot(p.ray) + nearer * (p.range[1] - p.range[0]);
        const Vec3f turn(dice.next(), dice.next(), dice.next());
        return make_plane(p.ray, inverse_depth, (normal_of(plane) + tilt * turn).normalized());
    }

    const GreyImage* reference_;
    std::vector<const GreyImage*> sources_;
    SearchBall region_;
    std::vector<CameraPair> pairs_;
    std::vector<InversePlane> planes_;
    std::vector<float> costs_;
};

}  // namespace

Pyramid pyramid_of(GreyImage image) {
    Pyramid pyramid;
    pyramid.push_back(std::move(image));
    while (std::max(pyramid.back().camera.width, pyramid.back().camera.height) > coarsest_side)
        pyramid.push_back(halved(pyramid.back()));
    return pyramid;
}

PlaneMap match_patches(const Pyramid& reference, std::span<const Pyramid* const> sources, const SearchBall& region,
                       float most_cost, uint64_t seed) {
    const auto level_at = [&](size_t l) {
        std::vector<const GreyImage*> images;
        for (const Pyramid* source : sources.first(std::min(sources.size(), most_sources)))
            images.push_back(&(*source)[std::min(l, source->size() - 1)]);
        return Level(reference[l], std::move(images), region);
    };
    const size_t coarsest = reference.size() - 1;
    Level level = level_at(coarsest);
    level.sweep();
    float depth_scale = 1.0f / swept_planes, normal_scale = 0.5f;
    for (int round = 0; round < coarsest_rounds; ++round, normal_scale *= 0.7f, depth_scale *= 0.7f)
        level.improve(round, depth_scale, normal_scale, seed);
    for (size_t l = coarsest; l-- > 0;) {
        Level finer = level_at(l);
        finer.take_over(level);
        for (int round = 0; round < rounds; ++round, normal_scale *= 0.7f, depth_scale *= 0.7f)
            finer.improve(round, depth_scale, normal_scale, seed + l + 1);
        std::swap(level, finer);
    }
    PlaneMap map{reference[0].camera, level.planes()};
    for (size_t i = 0; i < map.planes.size(); ++i)
        if (level.cost(i) > most_cost) map.planes[i] = InversePlane::Zero();
    return map;
}

}  // namespace radiafit::tools
