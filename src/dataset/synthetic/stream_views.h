#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "dataset/dataset.h"

namespace radiafit {

/// Makes images in parallel, a few per thread at a time, and appends them to a dataset in order: memory does not grow
/// with their number. `make(i, worker, bytes)` fills view i's pixels, reusing the storage of `bytes`, and describes it.
void stream_views(size_t count, DatasetWriter& writer,
                  const std::function<View(size_t i, int worker, std::vector<uint8_t>& bytes)>& make);

}  // namespace radiafit
