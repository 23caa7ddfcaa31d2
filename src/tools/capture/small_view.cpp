#include "capture/small_view.h"

#include <algorithm>

#include "base/parallel.h"
#include "capture/image_scale.h"
#include "dataset/image_stream.h"

namespace radiafit::tools {
namespace {

/// Camera, colours and mask of an image and a mask at the small size.
SmallView made_small(std::string name, const Camera& camera, const ImageFile& image, const std::vector<uint8_t>& mask) {
    SmallView view{std::move(name), scaled_camera(camera, small_view_side), {}, {}};
    const int width = view.camera.width, height = view.camera.height;
    const ImageFile small = width == image.width && height == image.height ? image : scale_down(image, width, height);
    view.rgb.resize(size_t(width) * size_t(height) * 3);
    for (size_t i = 0; i < view.rgb.size(); ++i)
        view.rgb[i] = small.bits == 32  ? static_cast<float>(srgb_encode(std::clamp(double(small.rgb32[i]), 0.0, 1.0)))
                      : small.bits == 8 ? float(small.rgb8[i]) / 255.0f
                                        : float(small.rgb16[i]) / 65535.0f;
    if (small.bits != 32 && small.linear)
        for (float& value : view.rgb) value = static_cast<float>(srgb_encode(value));
    if (!mask.empty()) view.mask = scale_down_mask(mask, image.width, image.height, width, height);
    return view;
}

}  // namespace

SmallView small_view(const Photograph& photograph, const LoadedPhotograph& loaded) {
    return made_small(photograph.name, photograph.camera, loaded.image, loaded.mask);
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
