#include "samples/image_samples.h"

#include <stdexcept>

#include "base/parallel.h"

namespace radiafit {
namespace {

void take(const Distribution& distribution, const TargetImage& image, uint32_t texels_per_tile, ImageSamples& out) {
    out.covered_pixels = distribution.covered_pixels;
    out.runs.clear();
    out.samples.clear();
    out.samples.reserve(distribution.kept_pixels);
    const auto tiles = static_cast<uint32_t>(distribution.texel_pixel.size() / texels_per_tile);
    const uint32_t* pixel = distribution.texel_pixel.data();
    for (uint32_t tile = 0; tile < tiles; ++tile, pixel += texels_per_tile) {
        const size_t before = out.samples.size();
        for (uint32_t local = 0; local < texels_per_tile; ++local) {
            if (pixel[local] == no_pixel) continue;
            const std::array<uint16_t, 4> c = image.channel16(pixel[local]);
            out.samples.push_back({{c[0], c[1], c[2]}, static_cast<uint16_t>(local)});
        }
        if (out.samples.size() > before) out.runs.push_back({tile, static_cast<uint32_t>(before)});
    }
    out.runs.push_back({tiles, static_cast<uint32_t>(out.samples.size())});
}

}  // namespace

SampleCollector::SampleCollector(const Dataset& dataset, const Atlas& atlas, std::vector<Distributor*> workers,
                                 TargetSpace space)
    : dataset_(&dataset), texels_per_tile_(atlas.texels_per_tile()), workers_(std::move(workers)) {
    if (texels_per_tile_ > 65536) throw std::invalid_argument("SampleCollector: a tile of more than 65536 texels");
    if (workers_.empty()) throw std::invalid_argument("SampleCollector: no distributor");
    if (workers_.size() > 1 && workers_.size() < size_t(thread_count()))
        throw std::invalid_argument("SampleCollector: fewer distributors than threads");
    const size_t at_once = workers_.size() == 1 ? 1 : size_t(thread_count());
    for (size_t k = 0; k < at_once; ++k) state_.push_back({ImageStream(dataset, StreamSource::disk, space), {}, {}});
}

float SampleCollector::scale() const {
    const ImageStream& any = state_.front().stream;
    return any.scale16();
}

void SampleCollector::collect(std::span<const uint32_t> views, std::span<ImageSamples> out) {
    const auto one = [&](size_t k, int worker) {
        auto& [stream, image, distribution] = state_[size_t(worker)];
        stream.load(views[k], image);
        workers_[size_t(worker)]->distribute(dataset_->views[views[k]].camera, image, distribution);
        take(distribution, image, texels_per_tile_, out[k]);
    };
    if (workers_.size() == 1) {
        for (size_t k = 0; k < views.size(); ++k) one(k, 0);
    } else {
        parallel_for(views.size(), 1, one);
    }
}

}  // namespace radiafit
