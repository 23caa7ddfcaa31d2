#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "fitting/families/fitted_models.h"
#include "fitting/parts/by_view_parts.h"
#include "fitting/resolve_options.h"
#include "fitting/solvers/solver.h"
#include "viewbasis/solve_view_basis.h"
#include "viewbasis/view_basis_fit.h"

namespace radiafit::fits {
namespace {

ViewBasisOptions view_basis_options_of(const FitRequest& request) {
    ViewBasisOptions options = request.own<ViewBasisOptions>();
    options.noise = request.own<ByViewOptions>().noise;
    options.blocks = request.own<ByViewOptions>().blocks;
    return options;
}

struct ViewBasisModel {
    using Fit = ViewBasisFit;
    static constexpr const char* name = view_basis_name;
    static constexpr auto read = read_view_basis;
    static constexpr const char* have = "a view basis has";
    static size_t numbers(const FitRequest& request) { return 3 * size_t(view_basis_options_of(request).rank); }

    static std::vector<bool> looked_at(const TriangleAtlas& atlas, const FitRequest& request) {
        return learned_from(atlas, view_basis_options_of(request));
    }
    static void begin(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                      const FitRequest& request, Fit& fit, FinishedFit& out) {
        const Stopwatch clock;
        fit.basis = learn_view_basis(dataset, atlas, samples, view_basis_options_of(request), request.journal.get());
        out.times_json = nlohmann::json{{"learning_s", clock.wall_s()}}.dump();
        out.note = fmt::format("basis learned in {:.1f} s, ", clock.wall_s());
    }
    static void solve(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                      const FitRequest& request, Fit& fit, FitRun& run) {
        const auto context = request.on_engine(EngineKind::compute) ? open_context(request, run) : nullptr;
        ViewBasisSolution solution = context
                                         ? solve_on_device(dataset, atlas, samples, fit.basis)
                                         : solve_view_basis(dataset, atlas, samples, fit.basis, request.journal.get());
        fit.parameters = std::move(solution.parameters);
        fit.samples = std::move(solution.samples);
        fit.error = std::move(solution.error);
        fit.iterations.assign(fit.samples.size(), 0);
        for (const uint32_t seen : fit.samples)
            fit.status.push_back(seen > 0 ? Status::stationary : Status::no_samples);
    }

    static void keep(const Fit& fit, PartResult& out) {
        out.own_json = description_of(fit.basis);
        out.own = fit.basis.numbers;
    }
    /// The same basis in all parts.
    static void take(const PartResult& part, Fit& whole) { take_basis(part, whole.basis, described_basis); }
    static void complete(const TriangleAtlas&, Fit&) {}

    static PlanRow common(const FitRequest& request) {
        const ViewBasisOptions o = view_basis_options_of(request);
        const uint64_t numbers = uint64_t(o.blocks) * view_terms * uint64_t(o.rank + 3);
        return {"basis, about", fmt::format("{} blocks x {} floats", o.blocks, view_terms * (o.rank + 3)), numbers,
                numbers * sizeof(float)};
    }
    static uint64_t most_looked_at(const FitRequest& request) {
        return most_learned_from(view_basis_options_of(request));
    }
    static std::vector<PlanRow> working(const TriangleAtlas& atlas, const FitRequest& request) {
        std::vector<PlanRow> rows{{"learning", fmt::format("places of {} texels, sums", most_looked_at(request)),
                                   most_looked_at(request), learning_bytes(atlas, view_basis_options_of(request)),
                                   PlanRow::while_learning}};
        if (request.on_engine(EngineKind::compute))
            rows.push_back({"tiles for the device", "some at a time, there and here", 1, bytes_on_device(),
                            PlanRow::while_solving});
        return rows;
    }
};

std::vector<FitOption> view_basis_options() {
    return by_view_options({rows::number("rank", 0, rows::own(&ViewBasisOptions::rank), limits::rank,
                                         "functions of the view direction: three times as many numbers per texel"),
                            noise_option(), blocks_option()});
}

/// Unless a solver or an engine is asked for: then light field maps are what it is for.
std::optional<Chosen> choose_view_basis(const Given& given, const Dataset& dataset, const FitRequest&) {
    if (dataset.light_moves() || given("--solver") || given("--engine")) return {};
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

}  // namespace

std::string description_of(const FittedViewBasis& m) {
    const ViewBasis& basis = m.fit.basis;
    return fmt::format("view basis of rank {} in {} blocks of the surface, {} numbers in each of {} texels", basis.rank,
                       basis.cubes.size(), 3 * basis.rank, m.atlas->used_texels());
}

std::vector<FitArray> arrays_of(const FittedViewBasis& m, const Dataset&) {
    const auto rank = uint64_t(m.fit.basis.rank);
    return {FitArray::of("texels", "texel, function of the basis, channel", m.fit.parameters.data(),
                         {m.fit.parameters.size() / (3 * rank), rank, 3})};
}

void export_parameters(const FittedViewBasis&, const Dataset&, ProblemFolder&) { refuse_export<ViewBasisModel>(); }

const Family view_bases = [] {
    Family family = family_by_view<ViewBasisModel>();
    family.name = "view bases";
    family.help = "viewbasis is colours by view direction in each texel, on a basis that is learned over the surface";
    family.options = view_basis_options;
    family.facts = [](const Solver& solver) -> std::optional<SolverFacts> {
        if (solver.solve == solve_stream) return SolverFacts{.on_engine = true};
        return {};
    };
    family.choose = choose_view_basis;
    family.resolve_options = resolve_by_view;
    family.candidates = view_basis_candidates;
    return family;
}();

}  // namespace radiafit::fits
