#include "dataset/stream_views.h"

#include <algorithm>

#include "base/log.h"
#include "base/parallel.h"

namespace radiafit {

void stream_views(const std::string& task, size_t count, DatasetWriter& writer,
                  const std::function<View(size_t i, int worker, PackedImage& image)>& make) {
    const size_t batch = 2 * static_cast<size_t>(thread_count());
    std::vector<PackedImage> images(batch);
    std::vector<View> views(batch);
    Progress progress(task, count);
    for (size_t first = 0; first < count; first += batch) {
        const size_t size = std::min(batch, count - first);
        parallel_for(size, 1, [&](size_t i, int worker) {
            views[i] = make(first + i, worker, images[i]);
            progress.advance();
        });
        for (size_t i = 0; i < size; ++i) writer.add(std::move(views[i]), images[i].pixels.data(), images[i].mask);
    }
}

}  // namespace radiafit
