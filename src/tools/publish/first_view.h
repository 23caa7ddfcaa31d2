#pragma once
#include <vector>

#include "dataset/dataset.h"

namespace radiafit::tools {

/// Which of the views, by their place in `views`, a page opens on. Of a mesh one that shows it whole, as nearly as any
/// of them does, and among these the one with the most training views around it, a near one counting more. Of a grid
/// the one whose lamp is nearest to halfway up from the upper left.
size_t first_view(const Dataset& dataset, const std::vector<uint32_t>& training, const std::vector<uint32_t>& views);

}  // namespace radiafit::tools
