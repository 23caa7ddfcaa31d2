#pragma once
#include "base/range.h"
#include "model/lfm.h"

/// What the options of models may be, for whoever reads one.
namespace radiafit::limits {

constexpr Range<int> terms{1, max_terms};
constexpr Range<int> map_side{2, 64};
/// Beyond 1e6 a penalty's rounding, in 32 bits, is as large as the data term, and its squares leave their range.
constexpr Range<double> weight{0, 1e6};
constexpr Range<double> share{0, 1, "0 is off"};
constexpr Range<double> loss_scale{1e-6, 1e6};

}  // namespace radiafit::limits
