#include <fmt/format.h>

#include "app/fitted_by_view.h"
#include "sg/sg_fit.h"

namespace radiafit {
namespace {

struct SgWords {
    static constexpr const char* have = "spherical Gaussians have";
    static std::string describe(const SgFit& fit, const TriangleAtlas& atlas) {
        return fmt::format("diffuse colour and {} spherical Gaussian{}, {} numbers in each of {} texels", fit.lobes,
                           fit.lobes == 1 ? "" : "s", sg_parameters(fit.lobes), atlas.used_texels());
    }
};

FinishedFit fit_sg(const Dataset& dataset, const FitRequest& request) {
    const auto solve = [&](const TriangleAtlas& atlas, const SampleList& samples, SgFit& fit, FinishedFit& out) {
        fit.lobes = request.lobes;
        fit.up = mean_up(dataset);
        SgSolution solution =
            solve_sg(dataset, atlas, samples, fit.up,
                     {.lobes = request.lobes, .noise = request.view_basis.noise, .iterations = request.iterations});
        fit.parameters = std::move(solution.parameters);
        fit.samples = std::move(solution.samples);
        fit.error = std::move(solution.error);
        fit.iterations = std::move(solution.iterations);
        fit.status = std::move(solution.status);
        out.note = fmt::format("{} texels, ", atlas.used_texels());
    };
    return fit_by_view<SgFit, SgWords>(dataset, request, solve);
}

}  // namespace

const Family spherical_gaussians = {
    .name = "spherical Gaussians",
    .owns = [](const std::string& model) { return model == sg_name; },
    .models = [] { return std::vector<std::string>{sg_name}; },
    .help = "sg is a diffuse colour and lobes about directions of view in each texel",
    .has_error_bars = false,
    .uses = [](const Solver& solver) -> uint32_t {
        return solver.solve == solve_stream
                   ? use::sides | use::surface_lookup | use::space | use::iterations | use::lobes
                   : 0;
    },
    .streamed = [](const FitRequest& request) -> std::optional<TargetSpace> { return request.space; },
    .settle =
        [](const auto& given, const Dataset& dataset, FitRequest& request) {
            settle_by_view(given, dataset, request);
            if (!given("--iterations")) request.iterations = SgOptions().iterations;  // more gain nothing that is seen
        },
    .plan = plan_sg,
    .fit = fit_sg,
    .divide = [](const Dataset&, const FitRequest&) -> std::unique_ptr<Divided> {
        throw UserError(fmt::format("spherical Gaussians are fitted in one piece; leave out {} and {}",
                                    option_name("memory"), option_name("shard")));
    },
    .export_problems = [](const Dataset&, const FitRequest&, ProblemFolder&) { refuse_export<SgWords>(); },
    .open = [](const std::filesystem::path& folder, const std::filesystem::path& moved_to) -> std::unique_ptr<Fitted> {
        return std::make_unique<FittedByView<SgFit, SgWords>>(read_sg(folder, moved_to));
    },
};

}  // namespace radiafit
