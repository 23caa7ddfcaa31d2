#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "fitting/families/fitted_models.h"
#include "fitting/parts/by_view_parts.h"
#include "fitting/solvers/solver.h"
#include "sg/sg_fit.h"
#include "viewbasis/texel_views.h"

namespace radiafit::fits {
namespace {

SgOptions sg_options_of(const FitRequest& request) {
    SgOptions options = request.own<SgOptions>();
    options.noise = request.own<ByViewOptions>().noise;
    options.iterations = request.iterations;
    return options;
}

struct SgModel {
    using Fit = SgFit;
    static constexpr const char* name = sg_name;
    static constexpr auto read = read_sg;
    static constexpr const char* have = "spherical Gaussians have";
    static size_t numbers(const FitRequest& request) { return size_t(sg_parameters(sg_options_of(request).lobes)); }

    static std::vector<bool> looked_at(const TriangleAtlas&, const FitRequest&) { return {}; }
    static void begin(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList&, const FitRequest& request,
                      Fit& fit, FinishedFit& out) {
        fit.lobes = sg_options_of(request).lobes;
        fit.up = mean_up(dataset);
        out.note = fmt::format("{} texels, ", atlas.used_texels());
    }
    static void solve(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                      const FitRequest& request, Fit& fit, FitRun&) {
        SgSolution solution = solve_sg(dataset, atlas, samples, fit.up, sg_options_of(request), request.journal.get());
        fit.parameters = std::move(solution.parameters);
        fit.samples = std::move(solution.samples);
        fit.error = std::move(solution.error);
        fit.iterations = std::move(solution.iterations);
        fit.status = std::move(solution.status);
        fit.colours = solution.colours;
    }

    static void keep(const Fit& fit, PartResult& out) {
        const ColourSum& sum = fit.colours;
        out.own_json = nlohmann::json{{"lobes", fit.lobes},
                                      {"up", numbers_of(fit.up)},
                                      {"rgb", sum.rgb},
                                      {"samples", sum.samples},
                                      {"scale", double(sum.scale)}}
                           .dump();
    }
    static void take(const PartResult& part, Fit& whole) {
        const auto own = nlohmann::json::parse(part.own_json);
        whole.lobes = own.at("lobes");
        whole.up = vector_of(own.at("up"));
        whole.colours.add({.rgb = own.at("rgb"), .samples = own.at("samples"), .scale = own.at("scale")});
    }
    static void complete(const TriangleAtlas& atlas, Fit& whole) {
        colour_unseen(atlas, whole.samples, whole.lobes, whole.colours.mean(), whole.parameters);
    }

    static PlanRow common(const FitRequest&) { return {}; }
    static uint64_t most_looked_at(const FitRequest&) { return 0; }
    static std::vector<PlanRow> working(const TriangleAtlas&, const FitRequest&) { return {}; }
};

}  // namespace

std::string description_of(const FittedSg& m) {
    return fmt::format("diffuse colour and {} spherical Gaussian{}, {} numbers in each of {} texels", m.fit.lobes,
                       m.fit.lobes == 1 ? "" : "s", sg_parameters(m.fit.lobes), m.atlas->used_texels());
}

std::vector<FitArray> arrays_of(const FittedSg& m, const Dataset&) {
    const auto numbers = uint64_t(sg_parameters(m.fit.lobes));
    return {FitArray::of("texels",
                         "texel, number: diffuse colour; of each lobe its colour; of each lobe x, y, log sharpness",
                         m.fit.parameters.data(), {m.fit.parameters.size() / numbers, numbers})};
}

void export_parameters(const FittedSg&, const Dataset&, ProblemFolder&) { refuse_export<SgModel>(); }

const Family spherical_gaussians = [] {
    Family family = family_by_view<SgModel>();
    family.name = "spherical Gaussians";
    family.help = "sg is a diffuse colour and lobes about directions of view in each texel";
    family.options = [] {
        return by_view_options({noise_option(), rows::number("lobes", 0, rows::own(&SgOptions::lobes), limits::lobes,
                                                             "spherical Gaussians of a texel: six numbers each, "
                                                             "besides three of the diffuse colour")});
    };
    family.facts = [](const Solver& solver) -> std::optional<SolverFacts> {
        if (solver.solve == solve_stream) return SolverFacts{.iterates = true};
        return {};
    };
    family.choose = [](const Given&, const Dataset& dataset, const FitRequest&) -> std::optional<Chosen> {
        if (dataset.light_moves()) return {};
        return Chosen{{{"model", sg_name}}, nullptr};
    };
    family.resolve_options = [](const Given& given, const Dataset& dataset, FitRequest& request) {
        resolve_by_view(given, dataset, request);
        if (!given("--iterations")) request.iterations = SgOptions().iterations;  // more gain nothing that is seen
    };
    family.candidates = [](const Dataset& dataset) -> std::vector<TuneCandidate> {
        if (dataset.light_moves()) return {};
        return {
            {{{{"model", sg_name}, {"lobes", "4"}}}, {{"lobes", {"1", "2", "3", "4"}}, noise_ladder(), side_ladder()}}};
    };
    return family;
}();

}  // namespace radiafit::fits
