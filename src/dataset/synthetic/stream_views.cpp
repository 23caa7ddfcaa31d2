#include "dataset/synthetic/stream_views.h"

#include <algorithm>

#include "base/log.h"
#include "base/parallel.h"

namespace radiafit {

void stream_views(size_t count, DatasetWriter& writer,
                  const std::function<View(size_t i, int worker, std::vector<uint8_t>& bytes)>& make) {
    const size_t batch = 4 * static_cast<size_t>(thread_count());
    std::vector<std::vector<uint8_t>> bytes(batch);
    std::vector<View> views(batch);
    Progress progress("generate", count);
    for (size_t first = 0; first < count; first += batch) {
        const size_t size = std::min(batch, count - first);
        parallel_for(size, 1, [&](size_t i, int worker) {
            views[i] = make(first + i, worker, bytes[i]);
            progress.advance();
        });
        for (size_t i = 0; i < size; ++i) writer.add(views[i], bytes[i].data(), {});
    }
}

}  // namespace radiafit
