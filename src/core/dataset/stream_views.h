#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "dataset/dataset.h"

namespace radiafit {

/// One image as a dataset takes it.
struct PackedImage {
    std::vector<uint8_t> pixels;  ///< [height][width][3] in the dataset's encoding
    std::vector<uint8_t> mask;    ///< [height][width], 0 = left out; empty: none is
};

/// Makes images in parallel, a few per thread at a time, and appends them to a dataset in order: memory does not grow
/// with their number. `make(i, worker, image)` fills view i's image, reusing its storage, and describes it. `task` is
/// what progress is shown of.
void stream_views(const std::string& task, size_t count, DatasetWriter& writer,
                  const std::function<View(size_t i, int worker, PackedImage& image)>& make);

}  // namespace radiafit
