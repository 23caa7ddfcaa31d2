#pragma once
#include <span>

#include "claims/findings.h"
#include "page/html.h"

namespace radiafit::harness {

/// What several software renderers say of the same claims, side by side: other OpenGLs, and no graphics
/// chip. Of one profile each, the paper's if there are two renderers of it. Empty where no claim has two.
Html renderers_part(std::span<const ClaimFindings> claims);

}  // namespace radiafit::harness
