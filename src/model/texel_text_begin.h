#pragma once
#include <algorithm>
#include <cmath>

#include "model/prelude.h"

/// model/texel_texts.h holds, for every model named in src/model/CMakeLists.txt, `texel_text::NAME<real>`: its shared
/// text for any scalar type; and RADIAFIT_TEXEL_MODELS(EACH), which expands to EACH(NAME) of all. What a text gives is
/// described in model/texel_local.h.
namespace radiafit::texel_text {
using std::exp, std::log, std::max, std::min;
}
