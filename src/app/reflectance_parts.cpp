#include <fmt/format.h>

#include "app/texel_parts.h"
#include "base/error.h"
#include "base/wording.h"

namespace radiafit {
namespace {

class DividedReflectance final : public DividedTexels {
public:
    DividedReflectance(const Dataset& dataset, const FitRequest& request)
        : DividedTexels(dataset, request, texel_atlas(dataset, request.model.surface_side),
                        size_t(request.texel_model()->parameters)) {}

    PartResult solve(const Part& part) const override {
        const ReflectanceOutcome outcome = solve_reflectance(part.dataset, part.request);
        return result_of(part, outcome.fit, outcome.fit.parameters, run_to_json(outcome, {}, outcome.samples));
    }

    FinishedFit finish() override {
        ReflectanceOutcome out;
        put_together(out.fit, out.fit.parameters);
        static_cast<FitRun&>(out) = run_.run();
        out.samples = run_.samples();
        out.fit.options = request_.texel_options();
        out.atlas = std::move(atlas_);
        return finished_reflectance(std::move(out), *dataset_);
    }
};

}  // namespace

std::unique_ptr<Divided> divide_texels(const Dataset& dataset, const FitRequest& asked) {
    asked.check();
    require_lights(dataset);
    if (asked.prior != PriorKind::none)
        throw UserError(fmt::format("{} is learned of the whole surface, in one piece; leave out it, or {} and {}",
                                    option_name("prior surface"), option_name("memory"), option_name("shard")));
    FitRequest request = asked;
    request.space = TargetSpace::linear;  // the only one that reflectance has
    return std::make_unique<DividedReflectance>(dataset, request);
}

}  // namespace radiafit
