#include "reachable/gaussian_process.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "base/rng.h"
#include "samples/interpolated_samples.h"
#include "viewbasis/texel_contestant.h"

namespace radiafit::fits {
namespace {

constexpr uint64_t draw_seed = 1;

/// Every stride_of()-th of a texel's samples is kept: kept_of() of them, at most most_samples.
size_t stride_of(size_t samples) {
    const size_t most = GaussianProcessTexels::most_samples;
    return std::max<size_t>(1, (samples + most - 1) / most);
}
size_t kept_of(size_t samples) { return (samples + stride_of(samples) - 1) / stride_of(samples); }

/// What the cameras of a sample list see of a texel, and the cameras' positions in the list's views.
struct SeenTexel {
    SeenColours colours;
    std::vector<uint32_t> images;
};

/// One thread's room for a tile.
class TileReader {
public:
    TileReader(const TriangleAtlas& atlas, const SampleList& samples, const std::vector<Vec3f>& eyes)
        : atlas_(&atlas), samples_(&samples), eyes_(&eyes) {}

    /// [texels of the tile]
    const std::vector<SeenTexel>& read(uint32_t tile) {
        const uint32_t count = atlas_->tile(tile).texels();
        texels_.assign(count, {});
        places_.resize(count);
        for (uint32_t local = 0; local < count; ++local)
            places_[local] = {atlas_->position(tile, local),
                              make_frame(atlas_->normal(tile * atlas_->texels_per_tile() + local))};
        for (uint32_t g = samples_->tile_groups[tile]; g < samples_->tile_groups[tile + 1]; ++g)
            for (const Sample& sample : samples_->of_group(g)) add(samples_->groups[g].image, sample);
        for (SeenTexel& texel : texels_) thin(texel);
        return texels_;
    }

private:
    struct Place {
        Vec3f position;
        Frame frame;
    };

    void add(uint32_t image, const Sample& sample) {
        const auto& [position, frame] = places_[sample.local];
        const Vec3f direction = ((*eyes_)[image] - position).normalized();
        SeenTexel& texel = texels_[sample.local];
        texel.colours.directions.push_back(direction);
        texel.colours.colours.push_back(samples_->scale * Vec3f(sample.rgb[0], sample.rgb[1], sample.rgb[2]));
        texel.colours.weights.push_back(view_sample_weight(frame.to_local(direction)));
        texel.images.push_back(image);
    }

    static void thin(SeenTexel& texel) {
        const size_t stride = stride_of(texel.images.size()), kept = kept_of(texel.images.size());
        if (stride == 1) return;
        const auto thinned = [&](auto& values) {
            for (size_t i = 0; i < kept; ++i) values[i] = values[i * stride];
            values.resize(kept);
        };
        thinned(texel.colours.directions);
        thinned(texel.colours.colours);
        thinned(texel.colours.weights);
        thinned(texel.images);
    }

    const TriangleAtlas* atlas_;
    const SampleList* samples_;
    const std::vector<Vec3f>* eyes_;
    std::vector<Place> places_;  ///< of the tile's texels
    std::vector<SeenTexel> texels_;
};

/// Colours of texels drawn evenly from those that some camera sees.
std::vector<SeenColours> drawn_texels(TileReader& reader, const TriangleAtlas& atlas, const SampleList& samples,
                                      int count) {
    std::vector<SeenColours> out;
    std::vector<uint32_t> tiles;
    for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile)
        if (samples.tile_groups[tile + 1] > samples.tile_groups[tile]) tiles.push_back(tile);
    Rng rng(draw_seed);
    for (int i = 0; i < count && !tiles.empty(); ++i) {
        const std::vector<SeenTexel>& texels = reader.read(tiles[rng.index(uint32_t(tiles.size()))]);
        const SeenTexel& texel = texels[rng.index(uint32_t(texels.size()))];
        if (texel.colours.size() > 0) out.push_back(texel.colours);
    }
    return out;
}

/// Where learning begins: the colours' mean, and their variance shared out.
DirectionProcess first_guess(const std::vector<SeenColours>& places) {
    double count = 0, squares = 0;
    Vec3d sum = Vec3d::Zero();
    for (const SeenColours& place : places)
        for (const Vec3f& colour : place.colours) {
            sum += colour.cast<double>();
            squares += colour.cast<double>().squaredNorm();
            count += 1;
        }
    DirectionProcess process;
    if (count == 0) return process;
    process.mean = sum / count;
    const double variance = std::max(squares / (3 * count) - process.mean.squaredNorm() / 3, 1e-6);
    process.level = 0.5 * variance;
    process.amplitude = 0.4 * variance;
    process.noise = 0.1 * variance;
    return process;
}

/// What a contestant keeps.
struct KeptTexels {
    TriangleAtlas atlas;
    GaussianProcessTexels texels;
    KeptTexels(const Dataset& dataset, const std::vector<uint32_t>& views, TargetSpace space,
               const GaussianProcessOptions& options)
        : atlas(dataset.mesh, options.surface_side),
          texels(dataset, atlas, interpolated_samples(dataset, atlas, views, space), options) {}
};

}  // namespace

GaussianProcessTexels::GaussianProcessTexels(const Dataset& dataset, const TriangleAtlas& atlas,
                                             const SampleList& samples, const GaussianProcessOptions& options)
    : atlas_(&atlas) {
    for (const uint32_t view : samples.views) eyes_.push_back(dataset.views[view].camera.center().cast<float>());
    std::vector<TileReader> readers(size_t(thread_count()), {atlas, samples, eyes_});
    const std::vector<SeenColours> drawn = drawn_texels(readers[0], atlas, samples, options.texels);
    process_ = most_likely_process(drawn, first_guess(drawn));

    // Where each texel's samples go, then what they weigh.
    first_.assign(size_t(atlas.texel_count()) + 1, 0);
    for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile)
        for (uint64_t s = samples.groups[samples.tile_groups[tile]].first,
                      end = samples.groups[samples.tile_groups[tile + 1]].first;
             s < end; ++s)
            ++first_[size_t(tile) * atlas.texels_per_tile() + samples.samples[s].local + 1];
    for (size_t texel = 1; texel < first_.size(); ++texel) first_[texel] = first_[texel - 1] + kept_of(first_[texel]);
    kept_.resize(first_.back());
    parallel_for(atlas.tile_count(), 16, [&](size_t tile, int worker) {
        if (atlas.degenerate(uint32_t(tile))) return;
        size_t texel = tile * atlas.texels_per_tile();
        for (const SeenTexel& seen : readers[size_t(worker)].read(uint32_t(tile))) {
            const auto weights = posterior_weights(process_, seen.colours).cast<float>().eval();
            for (size_t i = 0; i < seen.images.size(); ++i) {
                Kept& kept = kept_[first_[texel] + i];
                Vec3f::Map(kept.weight) = weights.row(Eigen::Index(i)).transpose();
                kept.image = seen.images[i];
            }
            ++texel;
        }
    });
}

Vec3f GaussianProcessTexels::colour(uint32_t texel, const Vec3f& eye) const {
    const Vec3f position = atlas_->position(texel), direction = (eye - position).normalized();
    const auto level = float(process_.level), amplitude = float(process_.amplitude);
    const auto scale = float(std::sqrt(5.0) / process_.length);
    Vec3f sum = process_.mean.cast<float>();
    for (uint64_t i = first_[texel]; i < first_[texel + 1]; ++i) {
        const Vec3f seen_from = (eyes_[kept_[i].image] - position).normalized();
        const float r = scale * (seen_from - direction).norm();
        sum += (level + amplitude * (1 + r + r * r / 3) * std::exp(-r)) * Vec3f::Map(kept_[i].weight);
    }
    return sum;
}

Contestant gaussian_process_of(const Dataset& dataset, const std::vector<uint32_t>& views, TargetSpace space,
                               const GaussianProcessOptions& options) {
    require_light_field(dataset);
    const auto kept = std::make_shared<KeptTexels>(dataset, views, space, options);
    return texel_contestant(kept->atlas, SurfaceLookup::nearest, space,
                            [kept](uint32_t texel, const Vec3f& eye) { return kept->texels.colour(texel, eye); });
}

}  // namespace radiafit::fits
