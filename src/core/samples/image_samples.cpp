#include "samples/image_samples.h"

#include <stdexcept>

namespace radiafit {
SampleCollector::SampleCollector(const Dataset& dataset, uint32_t texels_per_block, std::vector<Distributor*> workers,
                                 TargetSpace space)
    : dataset_(&dataset), texels_per_block_(texels_per_block), workers_(std::move(workers)) {
    if (texels_per_block > 65536) throw std::invalid_argument("SampleCollector: a tile of more than 65536 texels");
    if (workers_.empty()) throw std::invalid_argument("SampleCollector: no distributor");
    if (workers_.size() > 1 && workers_.size() < size_t(thread_count()))
        throw std::invalid_argument("SampleCollector: fewer distributors than threads");
    const size_t at_once = workers_.size() == 1 ? 1 : size_t(thread_count());
    for (size_t k = 0; k < at_once; ++k) state_.push_back({ImageStream(dataset, StreamSource::disk, space)});
}

void SampleCollector::each(size_t count, const std::function<void(size_t k, int worker)>& body) {
    if (workers_.size() > 1) return parallel_for(count, 1, body);
    for (size_t k = 0; k < count; ++k) body(k, 0);
}

void SampleCollector::distribute(uint32_t view, int worker, ImageBlocks& out) {
    auto& [stream, image, distribution, locals, pixels, values] = state_[size_t(worker)];
    workers_[size_t(worker)]->distribute(dataset_->views[view].camera, image, distribution);
    out.covered_pixels = distribution.covered_pixels;
    out.blocks.clear();
    out.first.clear();
    const auto texels = uint32_t(distribution.texel_pixel.size());
    locals.resize(texels);
    pixels.resize(texels);
    uint32_t count = 0;
    for (uint32_t begin = 0; begin < texels; begin += texels_per_block_) {
        const uint32_t before = count, size = std::min(texels_per_block_, texels - begin);
        for (uint32_t local = 0; local < size; ++local) {
            const uint32_t pixel = distribution.texel_pixel[begin + local];
            locals[count] = local;
            pixels[count] = pixel;
            count += pixel != no_pixel;  // no branch: which do is hard to foresee
        }
        if (count == before) continue;
        out.blocks.push_back(begin / texels_per_block_);
        out.first.push_back(before);
    }
    out.first.push_back(count);
}

void SampleCollector::collect(std::span<const uint32_t> views, size_t first, std::span<ImageSamples<Sample>> out) {
    each(out.size(), [&](size_t k, int worker) {
        Worker& w = state_[size_t(worker)];
        w.stream.load(views[first + k], w.image);
        distribute(views[first + k], worker, out[k]);
        out[k].samples.resize(out[k].first.back());
        for (size_t i = 0; i < out[k].samples.size(); ++i) {
            const std::array<uint16_t, 4> c = w.image.channel16(w.pixels[i]);
            out[k].samples[i] = {{c[0], c[1], c[2]}, uint16_t(w.locals[i])};
        }
    });
}

void SampleCollector::collect(std::span<const uint32_t> views, size_t first,
                              std::span<ImageSamples<LinearSample>> out) {
    each(out.size(), [&](size_t k, int worker) {
        Worker& w = state_[size_t(worker)];
        w.stream.load_mask(views[first + k], w.image);
        distribute(views[first + k], worker, out[k]);
        const size_t count = out[k].first.back();
        w.values.resize(3 * count);
        w.stream.values_at({w.pixels.data(), count}, w.values.data());
        out[k].samples.resize(count);
        for (size_t i = 0; i < count; ++i) {
            const float* v = &w.values[3 * i];
            out[k].samples[i] = {{v[0], v[1], v[2]}, uint32_t(first + k) * texels_per_block_ + w.locals[i]};
        }
    });
}

}  // namespace radiafit
