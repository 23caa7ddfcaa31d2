#include "gl/image_sweep.h"

#include <algorithm>

#include "gl/view_order.h"

namespace radiafit {

std::array<int, 2> largest_image(const Dataset& dataset, std::span<const uint32_t> views) {
    std::array<int, 2> size{1, 1};
    for (uint32_t view : views) {
        size[0] = std::max(size[0], dataset.views[view].camera.width);
        size[1] = std::max(size[1], dataset.views[view].camera.height);
    }
    return size;
}

ImageSweep::ImageSweep(const Dataset& dataset, std::vector<uint32_t> views, StreamSource source, TargetSpace space,
                       bool resident)
    : dataset_(&dataset),
      views_(std::move(views)),
      stream_(dataset, source, space),
      resident_(resident),
      pixels_(dataset.has_grid() ? ImageSlot::Pixels::words : ImageSlot::Pixels::channels) {}

void ImageSweep::set_batch(int images) {
    if (images > 1 && !dataset_->has_grid()) views_ = batches_of_neighbours(*dataset_, views_, images);
    images_.resize(size_t(images));
    if (resident_) {
        for (uint32_t view : views_) {
            const Camera& camera = dataset_->views[view].camera;
            stream_.load(view, images_[0]);
            slots_.emplace_back(camera.width, camera.height, stream_.bits(), pixels_);
            slots_.back().upload(images_[0]);
        }
        return;
    }
    const auto [width, height] = largest();
    for (int i = 0; i < 2 * images; ++i) slots_.emplace_back(width, height, stream_.bits(), pixels_);
}

void ImageSweep::load(size_t first, size_t turn) {
    on_device_.clear();
    for (size_t i = 0; i < std::min(images_.size(), views_.size() - first); ++i) {
        const uint32_t view = views_[first + i];
        if (resident_) {
            on_device_.push_back({&dataset_->views[view].camera, &slots_[first + i].texture(), images_[0].scale16(),
                                  images_[0].bits, &dataset_->views[view]});
            continue;
        }
        stream_.load(view, images_[i]);
        const double begin = wall_time_s();
        ImageSlot& slot = slots_[(turn % 2) * images_.size() + i];
        slot.upload(images_[i]);
        times_.upload_s += wall_time_s() - begin;
        on_device_.push_back({&dataset_->views[view].camera, &slot.texture(), images_[i].scale16(), images_[i].bits,
                              &dataset_->views[view]});
    }
}

}  // namespace radiafit
