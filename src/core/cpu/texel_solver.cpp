#include "cpu/texel_solver.h"

#include <stdexcept>

#include "cpu/texel_models.h"
#include "cpu/texel_solvers_of.h"

namespace radiafit {

const TexelSolvers& texel_solvers(const TexelModel& model) {
#define EACH(NAME)                                                   \
    if (model.name == std::string_view(#NAME)) {                     \
        static const TexelSolversOf<texel_text::NAME<Pack>> solvers; \
        return solvers;                                              \
    }
    RADIAFIT_TEXEL_MODELS(EACH)
#undef EACH
    throw std::invalid_argument("texel_solvers: an unknown model");
}

}  // namespace radiafit
