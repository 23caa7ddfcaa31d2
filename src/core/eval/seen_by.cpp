#include "eval/seen_by.h"

#include <algorithm>
#include <memory>
#include <mutex>

#include "base/parallel.h"
#include "eval/pixel_areas.h"

namespace radiafit {

std::vector<std::vector<uint32_t>> views_that_see(const Dataset& dataset, const ImageStream& stream,
                                                  const std::vector<uint32_t>& views) {
    std::vector<std::vector<uint32_t>> out(dataset.has_grid() ? dataset.grid.texel_count()
                                                              : size_t(dataset.mesh.triangle_count()));
    struct Tools {
        ImageStream stream;
        Rasterizer rasterizer = {};
        TargetImage mask = {};
    };
    std::vector<std::unique_ptr<Tools>> tools;
    tools.resize(size_t(thread_count()));
    std::mutex adding;
    parallel_for(views.size(), 1, [&](size_t i, int worker) {
        auto& tool = tools.at(size_t(worker));
        if (!tool) tool = std::make_unique<Tools>(stream.another());
        const View& view = dataset.views[views[i]];
        if (view.mask_offset) tool->stream.load_mask(views[i], tool->mask);
        const std::vector<RasterPixel> pixels = seen_pixels(dataset, view, tool->rasterizer);
        std::vector<bool> seen(out.size());
        for (size_t k = 0; k < pixels.size(); ++k)
            if (pixels[k].triangle != no_triangle && (!view.mask_offset || tool->mask.masked_in(k)))
                seen[pixels[k].triangle] = true;
        const std::lock_guard lock(adding);
        for (size_t t = 0; t < seen.size(); ++t)
            if (seen[t]) out[t].push_back(views[i]);
    });
    for (std::vector<uint32_t>& of : out) std::ranges::sort(of);
    return out;
}

}  // namespace radiafit
