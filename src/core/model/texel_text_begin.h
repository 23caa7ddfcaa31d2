#pragma once
#include <algorithm>
#include <cmath>

#include "model/prelude.h"

/// What a texel-local model's text may call (docs/texel-models.md). model/texel_texts.h holds `texel_text::NAME<real>`
/// for every model named in src/core/model/CMakeLists.txt, and RADIAFIT_TEXEL_MODELS(EACH), which expands to EACH(NAME)
/// of all.
namespace radiafit::texel_text {
using std::exp, std::log, std::max, std::min, std::sqrt;
}

#define RADIAFIT_TEXEL_STRING(NAME) RADIAFIT_TEXEL_STRING_OF(NAME)
#define RADIAFIT_TEXEL_STRING_OF(NAME) #NAME
