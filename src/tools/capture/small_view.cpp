#include "capture/small_view.h"

#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>

#include "base/parallel.h"
#include "dataset/image_stream.h"

namespace radiafit::tools {
namespace {

/// Means of blocks of pixels as they are stored, a whole number a side; what is left at the right and bottom is cut
/// off.
template <class Channel>
void average_blocks(const std::vector<Channel>& rgb, int old_width, int block, double largest, SmallView& view) {
    const auto width = size_t(view.camera.width), height = size_t(view.camera.height), side = size_t(block);
    const double unit = 1 / (largest * double(side * side));
    view.rgb.resize(width * height * 3);
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x) {
            std::array<std::conditional_t<std::is_floating_point_v<Channel>, double, uint64_t>, 3> sums{};
            for (size_t row = y * side; row < (y + 1) * side; ++row) {
                const Channel* pixel = rgb.data() + (row * size_t(old_width) + x * side) * 3;
                for (size_t k = 0; k < 3 * side; k += 3)
                    for (size_t c = 0; c < 3; ++c) sums[c] += pixel[k + c];
            }
            for (size_t c = 0; c < 3; ++c)
                view.rgb[(y * width + x) * 3 + c] = static_cast<float>(double(sums[c]) * unit);
        }
}

/// Camera, colours and mask of an image and a mask at the small size.
SmallView made_small(std::string name, const Camera& camera, const ImageFile& image, const std::vector<uint8_t>& mask) {
    const int block =
        std::clamp(std::max(image.width, image.height) / small_view_side, 1, std::min(image.width, image.height));
    SmallView view{std::move(name), camera, {}, {}};
    const int width = std::max(1, image.width / block), height = std::max(1, image.height / block);
    view.camera = camera.cropped(0, 0, width * block, height * block);
    view.camera.width = width, view.camera.height = height;
    view.camera.fx /= block, view.camera.fy /= block, view.camera.cx /= block, view.camera.cy /= block;
    if (image.bits == 8) average_blocks(image.rgb8, image.width, block, 255, view);
    if (image.bits == 16) average_blocks(image.rgb16, image.width, block, 65535, view);
    if (image.bits == 32) average_blocks(image.rgb32, image.width, block, 1, view);
    if (image.linear || image.bits == 32)
        for (float& value : view.rgb) value = static_cast<float>(srgb_encode(std::clamp(double(value), 0.0, 1.0)));
    if (mask.empty()) return view;
    view.mask.resize(size_t(width) * size_t(height));
    for (size_t i = 0; i < view.mask.size(); ++i) {  // the middle pixel of each block
        const size_t x = i % size_t(width) * size_t(block) + size_t(block) / 2;
        const size_t y = i / size_t(width) * size_t(block) + size_t(block) / 2;
        view.mask[i] = mask[y * size_t(image.width) + x];
    }
    return view;
}

}  // namespace

SmallView small_view(const Photograph& photograph, const LoadedPhotograph& loaded) {
    SmallView view = made_small(photograph.name, photograph.camera, loaded.image, loaded.mask);
    if (loaded.has_mask || view.mask.empty()) return view;
    // It says where an undistorted picture shows nothing, not where the object is.
    for (size_t i = 0; i < view.mask.size(); ++i)
        if (!view.mask[i]) std::fill_n(view.rgb.begin() + ptrdiff_t(3 * i), 3, std::numeric_limits<float>::quiet_NaN());
    view.mask.clear();
    return view;
}

std::vector<SmallView> small_views(const Dataset& dataset, size_t most) {
    const size_t count = std::min(most, dataset.views.size());
    std::vector<SmallView> views(count);
    const ImageStream stream(dataset, StreamSource::disk, TargetSpace::linear);
    std::vector<ImageStream> streams;
    for (int i = 0; i < thread_count(); ++i) streams.push_back(stream.another());
    parallel_for(count, 1, [&](size_t i, int worker) {
        const size_t v = i * dataset.views.size() / count;
        const Camera& camera = dataset.views[v].camera;
        ImageFile image;
        image.width = camera.width, image.height = camera.height, image.bits = 32, image.linear = true;
        TargetImage target;
        streams[size_t(worker)].load(static_cast<uint32_t>(v), target);
        streams[size_t(worker)].load_values(static_cast<uint32_t>(v), image.rgb32);
        std::vector<uint8_t> mask(size_t(camera.width) * size_t(camera.height));
        for (size_t p = 0; p < mask.size(); ++p) mask[p] = target.masked_in(p) ? 255 : 0;
        if (std::ranges::count(mask, 0) == 0) mask.clear();
        views[i] = made_small(dataset.views[v].name, camera, image, mask);
    });
    return views;
}

}  // namespace radiafit::tools
