#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/by_view_parts.h"
#include "app/settle.h"
#include "viewbasis/solve_view_basis.h"
#include "viewbasis/view_basis_fit.h"

namespace radiafit {
namespace {

ViewBasisOptions options_of(const FitRequest& request) {
    ViewBasisOptions options = request.own<ViewBasisOptions>();
    options.noise = request.own<ByViewOptions>().noise;
    return options;
}

struct ViewBasisModel {
    using Fit = ViewBasisFit;
    static constexpr const char* have = "a view basis has";
    static std::string describe(const Fit& fit, const TriangleAtlas& atlas) {
        return fmt::format("view basis of rank {} in {} blocks of the surface, {} numbers in each of {} texels",
                           fit.basis.rank, fit.basis.blocks.size(), 3 * fit.basis.rank, atlas.used_texels());
    }
    static size_t numbers(const FitRequest& request) { return 3 * size_t(options_of(request).rank); }

    static std::vector<bool> looked_at(const TriangleAtlas& atlas, const FitRequest& request) {
        return learned_from(atlas, options_of(request));
    }
    static void begin(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                      const FitRequest& request, Fit& fit, FinishedFit& out) {
        const Stopwatch clock;
        fit.basis = learn_view_basis(dataset, atlas, samples, options_of(request), request.journal.get());
        out.times_json = nlohmann::json{{"learning_s", clock.wall_s()}}.dump();
        out.note = fmt::format("basis learned in {:.1f} s, ", clock.wall_s());
    }
    static void solve(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                      const FitRequest& request, Fit& fit) {
        ViewBasisSolution solution = solve_view_basis(dataset, atlas, samples, fit.basis, request.journal.get());
        fit.parameters = std::move(solution.parameters);
        fit.samples = std::move(solution.samples);
        fit.error = std::move(solution.error);
        fit.iterations.assign(fit.samples.size(), 0);
        for (const uint32_t seen : fit.samples)
            fit.status.push_back(seen > 0 ? Status::stationary : Status::no_samples);
    }

    static void keep(const Fit& fit, PartResult& out) {
        StoredBasis basis = stored_basis(fit.basis);
        out.own_json = std::move(basis.json);
        out.own = std::move(basis.numbers);
    }
    /// The same basis in all parts.
    static void take(const PartResult& part, Fit& whole) {
        if (whole.basis.blocks.empty()) {
            whole.basis = described_basis(part.own_json);
            take_numbers(part.own, whole.basis);
        }
        const StoredBasis first = stored_basis(whole.basis);
        if (first.json != part.own_json || first.numbers != part.own) throw std::runtime_error("another basis");
    }
    static void complete(const TriangleAtlas&, Fit&) {}

    static uint64_t common_bytes(const FitRequest& request) { return blocks_bytes(options_of(request)); }
    static uint64_t blocks_bytes(const ViewBasisOptions& options) {
        return uint64_t(options.blocks) * view_terms * uint64_t(options.rank + 3) * sizeof(float);
    }
    static std::vector<PlanRow> plan_begin(const Dataset& dataset, const TriangleAtlas& atlas,
                                           const FitRequest& request, size_t most_views) {
        const ViewBasisOptions options = options_of(request);
        const uint64_t texels = most_learned_from(options);
        std::vector<PlanRow> rows = learning_rows(atlas, options);
        add_samples_of_some(dataset, atlas, request, most_views, texels, rows);
        return rows;
    }
    /// Besides samples.
    static std::vector<PlanRow> learning_rows(const TriangleAtlas& atlas, const ViewBasisOptions& options) {
        const uint64_t texels = std::min(atlas.used_texels(), most_learned_from(options));
        constexpr uint64_t drawing = 96;  // places, and which number went where
        constexpr uint64_t of_moments = (3 + 2 * view_terms) * view_terms * sizeof(double), at_once = 64;
        return {{"texels to learn from", fmt::format("{} texels drawn of {}", texels, atlas.used_texels()), texels,
                 texels * drawing + atlas.texel_count() / 8, PlanRow::while_learning},
                {"moments", fmt::format("{} texels at a time", at_once), uint64_t(options.texels) / at_once + 1,
                 (uint64_t(options.texels) / at_once + 1) * of_moments, PlanRow::while_learning}};
    }
};

std::vector<FitOption> view_basis_options() {
    return by_view_options({rows::number("rank", 0, rows::own(&ViewBasisOptions::rank), limits::rank,
                                         "functions of the view direction: three times as many numbers per texel"),
                            noise_option(),
                            rows::number("blocks", 0, rows::own(&ViewBasisOptions::blocks), limits::blocks,
                                         "about so many parts of the surface have a basis of their own")});
}

/// Unless a solver is asked for: then light field maps are what it is for.
std::optional<Chosen> choose_view_basis(const Given& given, const Dataset& dataset) {
    if (dataset.light_moves() || given("--solver")) return {};
    return Chosen{{{"model", view_basis_name}}, [&] {
                      return fmt::format("light that stays, a median of {:.3g} training views per texel",
                                         views_per_texel(dataset));
                  }};
}

std::vector<TuneCandidate> view_basis_candidates(const Dataset& dataset) {
    if (dataset.light_moves()) return {};
    return {{{{{"model", view_basis_name}, {"rank", "10"}}, {{"model", view_basis_name}, {"rank", "28"}}},
             {{"rank", {"4", "6", "10", "15", "20", "28"}},
              noise_ladder(),
              side_ladder(),
              {"blocks", {"1", "100", "400", "1600"}}}}};
}

Plan plan_view_basis(const Dataset& dataset, const FitRequest& request, size_t most_views) {
    const ViewBasisOptions options = options_of(request);
    Plan plan = plan_by_view(dataset, request, most_views, ViewBasisModel::numbers(request));
    const uint64_t bytes = ViewBasisModel::blocks_bytes(options);
    const std::string shape = fmt::format("{} blocks x {} floats", options.blocks, view_terms * (options.rank + 3));
    plan.disk.push_back({"basis, about", shape, bytes / sizeof(float), bytes});
    if (request.part) return plan;  // the whole has learned it
    plan.memory.push_back({"basis, about", shape, bytes / sizeof(float), bytes,
                           PlanRow::while_learning | PlanRow::while_solving | PlanRow::while_writing});
    for (PlanRow& row : ViewBasisModel::learning_rows(*by_view_atlas(dataset, request), options))
        plan.memory.push_back(std::move(row));
    return plan;
}

}  // namespace

const Family view_bases = {
    .name = "view bases",
    .owns = [](const std::string& model) { return model == view_basis_name; },
    .models = [] { return std::vector<std::string>{view_basis_name}; },
    .help = "viewbasis is colours by view direction in each texel, on a basis that is learned over the surface",
    .options = view_basis_options,
    .has_error_bars = false,
    .uses = [](const Solver& solver) -> uint32_t {
        return solver.solve == solve_stream ? use::sides | use::surface_lookup | use::space : 0;
    },
    .streamed = [](const FitRequest& request) -> std::optional<TargetSpace> { return request.space; },
    .choose = choose_view_basis,
    .settle = settle_by_view,
    .candidates = view_basis_candidates,
    // Mean colours would take an image that looks into the gloss for one that was exposed longer.
    .quick =
        [] {
            return FitSetting{{"model", view_basis_name}, {"rank", "6"}, {"surface_side", "4"}};
        },
    .plan = plan_view_basis,
    .fit = fit_by_view<ViewBasisModel>,
    .divide = divide_by_view<ViewBasisModel>,
    .export_problems = [](const Dataset&, const FitRequest&, ProblemFolder&) { refuse_export<ViewBasisModel>(); },
    .open = [](const std::filesystem::path& folder, const std::filesystem::path& moved_to) -> std::unique_ptr<Fitted> {
        return std::make_unique<FittedByView<ViewBasisModel>>(read_view_basis(folder, moved_to));
    },
};

}  // namespace radiafit
