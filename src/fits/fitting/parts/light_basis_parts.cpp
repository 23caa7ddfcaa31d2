#include <algorithm>
#include <optional>

#include "base/clock.h"
#include "fitting/families/fit_lamp_texels.h"
#include "fitting/parts/texel_parts.h"
#include "fitting/solvers/solver.h"

namespace radiafit::fits {
namespace {

/// The basis is learned once, from few texels of the whole; parts go on from there.
class DividedLightBasis final : public DividedTexels {
public:
    DividedLightBasis(const Dataset& dataset, const FitRequest& request)
        : DividedTexels(dataset, request, texel_atlas(dataset, request.model.surface_side),
                        light_basis_numbers(request)) {}

    PartResult solve(const Part& part) const override {
        const Stopwatch clock;
        FitRun run;
        if (!basis_) learn(run);
        LightBasisFit fit;
        fit.basis = *basis_;
        const auto atlas = texel_atlas(part.dataset, part.request.model.surface_side);
        const std::vector<uint32_t> views = fitted_views(part.dataset, part.request);
        const SharedTexels samples = distribute_texels(part.dataset, part.request, views);
        run.times.distribution += samples.seconds;
        const Stopwatch solving;
        const Underneath underneath(part.dataset, *atlas, views, samples, part.request);
        solve_lamp_texels(part.dataset, *atlas, views, samples, underneath, part.request, fit, run);
        run.times.optimization += solving.wall_s();
        run.times.total = clock.wall_s();
        PartResult out = result_of(part, fit, fit.parameters, run_to_json(run, {}));
        out.own_json = description_of(fit.basis);
        out.own = fit.basis.numbers;
        return out;
    }
    uint64_t learning_bytes(size_t) const override {
        return most_learned_from() * views_.size() * (sizeof(TexelRadiance) + 6 * sizeof(float));
    }
    uint64_t held_bytes() const override {
        return DividedTexels::held_bytes() + uint64_t(light_basis_options(request_).blocks) * 3 * most_reference_lamps *
                                                 uint64_t(1 + light_basis_options(request_).rank) * sizeof(float);
    }

    void add(const PartResult& result, const std::string& name) override {
        DividedTexels::add(result, name);
        try {
            take_basis(result, whole_.basis, described_light_basis);
        } catch (const std::exception&) {
            throw_foreign(name);
        }
    }
    FinishedFit finish(const EachPart&) override {
        put_together(whole_, whole_.parameters);
        whole_.surface_side = request_.model.surface_side;
        whole_.underneath = find_texel_model(request_.own<LightBasisOptions>().underneath);
        FinishedFit out;
        out.run = run_.run();
        out.fit = {FittedLightBasis{std::move(whole_), std::move(atlas_)}, *dataset_};
        return out;
    }

private:
    uint64_t most_learned_from() const {
        const LightBasisOptions o = light_basis_options(request_);
        return std::min<uint64_t>(atlas_->texel_count(),
                                  uint64_t(o.texels) + uint64_t(o.block_texels) * uint64_t(o.blocks));
    }
    void learn(FitRun& run) const {
        const Stopwatch clock;
        const std::vector<bool> texels = learned_from(*dataset_, *atlas_, light_basis_options(request_));
        SharedTexels samples;
        samples.source = gather_some(*dataset_, *atlas_, views_, request_, texels);
        run.times.distribution += clock.wall_s();
        const Stopwatch learning;
        const Underneath underneath(*dataset_, *atlas_, views_, samples, request_);
        basis_ = learn_light_basis(*dataset_, *atlas_, views_, *samples.source, light_basis_options(request_),
                                   underneath.light());
        run.times.optimization += learning.wall_s();
    }

    mutable std::optional<LightBasis> basis_;
    LightBasisFit whole_;  ///< of parts that were added
};

}  // namespace

std::unique_ptr<Divided> divide_light_basis(const Dataset& dataset, const FitRequest& request) {
    request.check();
    require_lit(dataset);
    FitRequest linear = request;
    linear.space = TargetSpace::linear;  // the only one that light bases have
    return std::make_unique<DividedLightBasis>(dataset, linear);
}

}  // namespace radiafit::fits
