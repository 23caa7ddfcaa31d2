#pragma once
#include "dataset/dataset.h"

namespace radiafit {

/// Whether pixels clip at a largest value that can be stored; floats don't.
inline bool has_largest_value(Encoding encoding) {
    return encoding != Encoding::f16_linear && encoding != Encoding::f32_linear;
}

}  // namespace radiafit
