#include "cpu/texel_solver.h"

#include <map>
#include <mutex>
#include <stdexcept>

#include "cpu/texel_models.h"
#include "cpu/texel_solvers_of.h"

namespace radiafit {
namespace {

struct Added {
    std::mutex mutex;
    std::map<const TexelModel*, std::unique_ptr<const TexelSolvers>> solvers;
};
Added& added() {
    static Added all;
    return all;
}

}  // namespace

void add_texel_solvers(const TexelModel& model, std::unique_ptr<const TexelSolvers> solvers) {
    const std::scoped_lock lock(added().mutex);
    added().solvers[&model] = std::move(solvers);
}

const TexelSolvers& texel_solvers(const TexelModel& model) {
#define EACH(NAME)                                                   \
    if (model.name == std::string_view(#NAME)) {                     \
        static const TexelSolversOf<texel_text::NAME<Pack>> solvers; \
        return solvers;                                              \
    }
    RADIAFIT_TEXEL_MODELS(EACH)
#undef EACH
    const std::scoped_lock lock(added().mutex);
    const auto found = added().solvers.find(&model);
    if (found == added().solvers.end()) throw std::invalid_argument("texel_solvers: an unknown model");
    return *found->second;
}

}  // namespace radiafit
