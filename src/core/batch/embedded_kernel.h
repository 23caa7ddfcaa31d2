#pragma once
#include <vector>

#include "base/embedded_text.h"

namespace radiafit::batch {

/// What a model's text is compiled with, by its path in the project.
const std::vector<EmbeddedText>& embedded_kernel();

}  // namespace radiafit::batch
