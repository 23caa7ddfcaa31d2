#include "fragment/image_sweep.h"

#include <algorithm>
#include <cstring>
#include <functional>

#include "fragment/view_order.h"
#include "gl/context.h"

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
                       bool keep_on_device)
    : dataset_(&dataset), views_(std::move(views)), stream_(dataset, source, space), keep_on_device_(keep_on_device) {}

void ImageSweep::set_batch(int images) {
    batch_ = images;
    by_all_threads_ = !Context::current().software();
    if (dataset_->has_grid())
        make_stacks();
    else
        make_slots();
    if (keep_on_device_) uploads_.reset();
    times_ = {};  // what came before sweeps is none of theirs
}

void ImageSweep::make_stacks() {
    const auto use = keep_on_device_ ? PixelUploads::Use::once : PixelUploads::Use::again_and_again;
    const auto [width, height] = largest();
    const size_t batch = size_t(batch_), turns = (views_.size() + batch - 1) / batch;
    for (size_t turn = 0; turn < (keep_on_device_ ? turns : std::min<size_t>(2, turns)); ++turn) {
        stacks_.emplace_back(width, height, bits(), batch_);
        if (!uploads_) uploads_.emplace(stacks_.back().bytes(), use);
        if (keep_on_device_) fill(stacks_.back(), turn * batch);
    }
}

void ImageSweep::make_slots() {
    const auto [width, height] = largest();
    uploads_.emplace(size_t(width) * size_t(height) * size_t(bits() / 2),
                     keep_on_device_ ? PixelUploads::Use::once : PixelUploads::Use::again_and_again);
    if (batch_ > 1) views_ = batches_of_neighbours(*dataset_, views_, batch_);
    if (!keep_on_device_) {
        for (int i = 0; i < 2 * batch_; ++i) slots_.emplace_back(width, height, bits());
        return;
    }
    for (uint32_t view : views_) {
        const Camera& camera = dataset_->views[view].camera;
        slots_.emplace_back(camera.width, camera.height, bits());
        fill(slots_.back(), view);
    }
}

template <class Body>
void ImageSweep::time_upload(const Body& body) {
    const double begin = wall_time_s();
    body();
    times_.upload_s += wall_time_s() - begin;
}

void ImageSweep::fill(ImageSlot& slot, uint32_t view) {
    const Camera& camera = dataset_->views[view].camera;
    const size_t row_bytes = size_t(camera.width) * size_t(bits() / 2);
    uint8_t* to = nullptr;
    time_upload([&] { to = uploads_->begin(); });
    const auto take = [&](int y, const uint8_t* row, int) { std::memcpy(to + size_t(y) * row_bytes, row, row_bytes); };
    stream_.load_rows(view, by_all_threads_, std::cref(take));  // by reference: a copy would take memory in every sweep
    time_upload([&] { slot.take(*uploads_, camera.width, camera.height); });
}

void ImageSweep::fill(ImageStack& stack, size_t first) {
    uint8_t* to = nullptr;
    time_upload([&] { to = stack.begin(*uploads_); });
    for (size_t i = 0; i < std::min(size_t(batch_), views_.size() - first); ++i) {
        const auto put = [&](int y, const uint8_t* row, int worker) { stack.put_row(to, int(i), y, row, worker); };
        stream_.load_rows(views_[first + i], by_all_threads_, std::cref(put));
    }
    time_upload([&] { stack.end(*uploads_); });
}

void ImageSweep::load(size_t first, size_t turn) {
    on_device_.clear();
    ImageStack* stack = stacks_.empty() ? nullptr : &stacks_[keep_on_device_ ? turn : turn % stacks_.size()];
    if (stack && !keep_on_device_) fill(*stack, first);
    for (size_t i = 0; i < std::min(size_t(batch_), views_.size() - first); ++i) {
        const uint32_t view = views_[first + i];
        ImageSlot* slot = stack ? nullptr : &slots_[keep_on_device_ ? first + i : (turn % 2) * size_t(batch_) + i];
        if (slot && !keep_on_device_) fill(*slot, view);
        on_device_.push_back({&dataset_->views[view].camera, stack ? &stack->texture() : &slot->texture(),
                              stream_.scale16(), bits(), &dataset_->views[view], first + i});
    }
}

}  // namespace radiafit
