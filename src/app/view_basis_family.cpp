#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/fitted_by_view.h"
#include "viewbasis/solve_view_basis.h"
#include "viewbasis/view_basis_fit.h"

namespace radiafit {
namespace {

struct ViewBasisWords {
    static constexpr const char* have = "a view basis has";
    static std::string describe(const ViewBasisFit& fit, const TriangleAtlas& atlas) {
        return fmt::format("view basis of rank {} in {} blocks of the surface, {} numbers in each of {} texels",
                           fit.basis.rank, fit.basis.blocks.size(), 3 * fit.basis.rank, atlas.used_texels());
    }
};

FinishedFit fit_view_basis(const Dataset& dataset, const FitRequest& request) {
    const auto solve = [&](const TriangleAtlas& atlas, const SampleList& samples, ViewBasisFit& fit, FinishedFit& out) {
        const Stopwatch clock;
        fit.basis = learn_view_basis(dataset, atlas, samples, request.view_basis);
        const double learning = clock.wall_s();
        ViewBasisSolution solution = solve_view_basis(dataset, atlas, samples, fit.basis);
        fit.parameters = std::move(solution.parameters);
        fit.samples = std::move(solution.samples);
        fit.error = std::move(solution.error);
        fit.iterations.assign(fit.samples.size(), 0);
        for (const uint32_t seen : fit.samples)
            fit.status.push_back(seen > 0 ? Status::stationary : Status::no_samples);
        out.times_json = nlohmann::json{{"learning_s", learning}}.dump();
        out.note = fmt::format("basis learned in {:.1f} s, ", learning);
    };
    return fit_by_view<ViewBasisFit, ViewBasisWords>(dataset, request, solve);
}

}  // namespace

const Family view_bases = {
    .name = "view bases",
    .owns = [](const std::string& model) { return model == view_basis_name; },
    .models = [] { return std::vector<std::string>{view_basis_name}; },
    .help = "viewbasis is colours by view direction in each texel, on a basis that is learned over the surface",
    .has_error_bars = false,
    .uses = [](const Solver& solver) -> uint32_t {
        return solver.solve == solve_stream ? use::sides | use::surface_lookup | use::space | use::view_basis : 0;
    },
    .streamed = [](const FitRequest& request) -> std::optional<TargetSpace> { return request.space; },
    .settle = settle_by_view,
    .plan = plan_view_basis,
    .fit = fit_view_basis,
    .divide = [](const Dataset&, const FitRequest&) -> std::unique_ptr<Divided> {
        throw UserError(fmt::format("a view basis is fitted in one piece; leave out {} and {}", option_name("memory"),
                                    option_name("shard")));
    },
    .export_problems = [](const Dataset&, const FitRequest&, ProblemFolder&) { refuse_export<ViewBasisWords>(); },
    .open = [](const std::filesystem::path& folder, const std::filesystem::path& moved_to) -> std::unique_ptr<Fitted> {
        return std::make_unique<FittedByView<ViewBasisFit, ViewBasisWords>>(read_view_basis(folder, moved_to));
    },
};

}  // namespace radiafit
