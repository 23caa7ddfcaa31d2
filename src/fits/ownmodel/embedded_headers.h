#pragma once
#include <vector>

#include "base/embedded_text.h"

namespace radiafit::fits {

/// What a text of a texel-local model is compiled with, by its path in the project.
const std::vector<EmbeddedText>& embedded_headers();

}  // namespace radiafit::fits
