#include "samples/interpolated_samples.h"

#include <cmath>
#include <memory>
#include <optional>

#include "base/parallel.h"
#include "geometry/mesh_part.h"
#include "samples/surface_photograph.h"

namespace radiafit {

class InterpolatedSampler::Worker {
public:
    Worker(const TriangleAtlas& atlas, ImageStream stream) : atlas_(atlas), stream_(std::move(stream)) {}

    /// `texels`: those to be looked at; null: all.
    void collect(uint32_t view, const Camera& camera, const std::vector<bool>* texels, ImageSamples<Sample>& out) {
        out = {};
        photograph_.load(stream_, view, camera, visible_mesh(atlas_.mesh()), rasterizer_);
        for (uint32_t tile = 0; tile < atlas_.tile_count(); ++tile) {
            const auto plane = atlas_.degenerate(tile) ? std::nullopt : photograph_.plane_of(atlas_.mesh(), tile);
            if (!plane) continue;
            const size_t before = out.samples.size();
            for (uint32_t local = 0; local < atlas_.tile(tile).texels(); ++local)
                if (!texels || (*texels)[size_t(tile) * atlas_.texels_per_tile() + local])
                    add(tile, local, *plane, out.samples);
            if (out.samples.size() == before) continue;
            out.blocks.push_back(tile);
            out.first.push_back(uint32_t(before));
        }
        out.first.push_back(uint32_t(out.samples.size()));
    }

private:
    void add(uint32_t tile, uint32_t local, const SurfacePhotograph::Plane& plane, std::vector<Sample>& out) const {
        const Vec3d p = photograph_.camera().project(atlas_.position(tile, local).cast<double>());
        if (!(p.z() > 0 && photograph_.contains(p.x(), p.y()))) return;
        if (!photograph_.sees(int(p.x()), int(p.y()), plane)) return;
        const SurfacePhotograph::Colour colour = photograph_.colour(p.x(), p.y(), plane);
        if (!(colour.share > 0)) return;
        const auto value = [&](size_t c) { return uint16_t(std::lround(colour.rgb[c])); };
        out.push_back({{value(0), value(1), value(2)}, uint16_t(local)});
    }

    const TriangleAtlas& atlas_;
    ImageStream stream_;
    Rasterizer rasterizer_;
    SurfacePhotograph photograph_;
};

InterpolatedSampler::InterpolatedSampler(const Dataset& dataset, const TriangleAtlas& atlas, TargetSpace space,
                                         const std::vector<bool>* texels)
    : dataset_(&dataset), atlas_(&atlas), texels_(texels) {
    const ImageStream stream(dataset, StreamSource::disk, space);
    scale_ = stream.scale16();
    for (int i = 0; i < thread_count(); ++i) workers_.push_back(std::make_unique<Worker>(atlas, stream.another()));
}
InterpolatedSampler::~InterpolatedSampler() = default;

int InterpolatedSampler::at_once() const { return int(workers_.size()); }

void InterpolatedSampler::collect(std::span<const uint32_t> views, size_t first, std::span<ImageSamples<Sample>> out) {
    parallel_for(out.size(), 1, [&](size_t k, int worker) {
        const uint32_t view = views[first + k];
        workers_[size_t(worker)]->collect(view, dataset_->views[view].camera, texels_, out[k]);
    });
}

SampleList interpolated_samples(const Dataset& dataset, const TriangleAtlas& atlas, const std::vector<uint32_t>& views,
                                TargetSpace space, const std::vector<bool>* texels) {
    InterpolatedSampler sampler(dataset, atlas, space, texels);
    std::vector<ImageSamples<Sample>> images(views.size());
    sampler.collect(views, 0, images);
    return list_by_tile(atlas.tile_count(), views, sampler.scale(), images);
}

InterpolatedCounts count_interpolated(const Dataset& dataset, const TriangleAtlas& atlas,
                                      const std::vector<uint32_t>& views, std::vector<uint64_t>* tiles) {
    InterpolatedSampler sampler(dataset, atlas, TargetSpace::stored);
    std::vector<ImageSamples<Sample>> images(size_t(sampler.at_once()));
    InterpolatedCounts sum;
    for (size_t first = 0; first < views.size(); first += images.size()) {
        const auto some = std::span(images).first(std::min(images.size(), views.size() - first));
        sampler.collect(views, first, some);
        for (const ImageSamples<Sample>& image : some) {
            sum.samples += image.samples.size();
            sum.groups += image.blocks.size();
            if (tiles)
                image.for_blocks(0, tiles->size(),
                                 [&](size_t tile, auto samples) { (*tiles)[tile] += samples.size(); });
        }
    }
    return sum;
}

}  // namespace radiafit
