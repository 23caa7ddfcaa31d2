#pragma once
#include <vector>

#include "base/embedded_text.h"

namespace radiafit {

/// The folder shaders/ as it was when the library was built.
const std::vector<EmbeddedText>& embedded_shaders();

}  // namespace radiafit
