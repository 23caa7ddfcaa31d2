#include "fitting/families/fit_lamp_texels.h"

#include <fmt/format.h>

#include "base/clock.h"
#include "base/error.h"
#include "cpu/texel_fit.h"
#include "fitting/families/fitted_by_view.h"
#include "fitting/solvers/solver.h"
#include "lightbasis/solve_light_basis.h"
#include "samples/only_texels.h"

namespace radiafit::fits {

LightBasisOptions light_basis_options(const FitRequest& request) {
    LightBasisOptions options = request.own<LightBasisOptions>();
    options.curve = request.value_curve();
    options.noise = request.own<ByViewOptions>().noise;
    options.blocks = request.own<ByViewOptions>().blocks;
    return options;
}

size_t light_basis_numbers(const FitRequest& request) {
    const TexelModel* underneath = find_texel_model(request.own<LightBasisOptions>().underneath);
    return size_t(light_basis_options(request).rank) + (underneath ? size_t(underneath->parameters) : 0);
}

void require_lit(const Dataset& dataset) {
    require_lights(dataset);
    if (!lamps_have_all_colours(dataset))
        throw UserError(
            fmt::format("{}: some lamps send no light of a colour, and a light basis has the channels share "
                        "their numbers; fit a reflectance model, such as lafortune",
                        dataset.folder.string()));
}

Underneath::Underneath(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                       const SharedTexels& samples, const FitRequest& request) {
    const std::string& name = request.own<LightBasisOptions>().underneath;
    if (name == no_model) return;
    FitRequest plain;
    plain.set("model", name).set("optimizer", "lm");
    plain.iterations = TexelFitOptions().iterations;
    plain.model.surface_side = request.model.surface_side;
    plain.distributor = request.distributor;
    plain.part = request.part;
    plain.journal = request.journal;
    fit_ = solve_reflectance(dataset, plain, {}, &views, &samples).fit;
    safe_ = std::make_unique<SafeRelighting>(dataset, views, atlas, fit_);
}

Underneath::Underneath(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                       const LightBasisFit& fit) {
    if (!fit.underneath) return;
    fit_ = underneath_of(fit);
    safe_ = std::make_unique<SafeRelighting>(dataset, views, atlas, fit_);
}

LightUnderneath Underneath::light() const {
    if (!safe_) return {};
    return [this](uint32_t texel, const View& view) { return safe_->colour_of(texel, view, 1); };
}

void solve_lamp_texels(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                       const SharedTexels& samples, const Underneath& underneath, const FitRequest& request,
                       LightBasisFit& fit, FitRun& run) {
    const TexelLightReader reader(dataset, atlas, views, fit.basis, underneath.light());
    const auto context = request.on_engine(EngineKind::compute) ? open_context(request, run) : nullptr;
    LightBasisSolution solution =
        context ? solve_on_device(atlas, *samples.source, reader, fit.basis)
                : solve_light_basis(atlas, *samples.source, reader, fit.basis, request.journal.get());
    fit.underneath = underneath.model();
    fit.samples = std::move(solution.samples);
    fit.error = std::move(solution.error);
    fit.iterations.assign(fit.samples.size(), 0);
    fit.status.clear();
    for (const uint32_t seen : fit.samples) fit.status.push_back(seen > 0 ? Status::stationary : Status::no_samples);
    if (!fit.underneath) {
        fit.parameters = std::move(solution.parameters);
        return;
    }
    const size_t rank = size_t(fit.basis.rank), own = fit.numbers() - rank;
    fit.parameters.clear();
    fit.parameters.reserve(fit.samples.size() * fit.numbers());
    for (size_t t = 0; t < fit.samples.size(); ++t) {
        fit.parameters.insert(fit.parameters.end(), &solution.parameters[t * rank],
                              &solution.parameters[t * rank] + rank);
        const float* under = &underneath.parameters()[t * own];
        fit.parameters.insert(fit.parameters.end(), under, under + own);
    }
}

LightBasisFit fit_lamp_texels(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                              const SharedTexels& samples, const FitRequest& request, FitRun* run, double* learning_s) {
    LightBasisFit fit;
    fit.surface_side = request.model.surface_side;
    const Underneath underneath(dataset, atlas, views, samples, request);
    const Stopwatch learning;
    fit.basis = learn_light_basis(dataset, atlas, views, *samples.source, light_basis_options(request),
                                  underneath.light(), request.journal.get());
    if (learning_s) *learning_s = learning.wall_s();
    FitRun ignored;
    solve_lamp_texels(dataset, atlas, views, samples, underneath, request, fit, run ? *run : ignored);
    return fit;
}

std::unique_ptr<TexelSource> gather_some(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                                         const FitRequest& request, const std::vector<bool>& texels) {
    const Distributors all = make_distributors(atlas, request);
    std::vector<OnlyTexels> only;
    for (Distributor* worker : all.workers()) only.emplace_back(*worker, texels);
    std::vector<Distributor*> workers;
    for (OnlyTexels& worker : only) workers.push_back(&worker);
    return gather_texels(dataset, atlas, views, workers);
}

}  // namespace radiafit::fits
