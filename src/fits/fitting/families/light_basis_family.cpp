#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/choose.h"
#include "base/clock.h"
#include "base/error.h"
#include "cpu/texel_fit.h"
#include "dataset/texel_shading.h"
#include "eval/safe_relighting.h"
#include "eval/texel_of_pixel.h"
#include "fitting/families/fit_lamp_texels.h"
#include "fitting/families/fitted_by_view.h"
#include "fitting/families/fitted_models.h"
#include "fitting/parts/texel_parts.h"
#include "fitting/plan/plan_rows.h"
#include "fitting/resolve_options.h"
#include "fitting/solvers/solver.h"
#include "lightbasis/light_basis_fit.h"
#include "lightbasis/solve_light_basis.h"
#include "samples/only_texels.h"

namespace radiafit::fits {
namespace {

LightBasisOptions options_of(const FitRequest& request) {
    LightBasisOptions options = request.own<LightBasisOptions>();
    options.noise = request.own<ByViewOptions>().noise;
    options.blocks = request.own<ViewBasisOptions>().blocks;
    return options;
}

/// What light bases have in place of options that other families have.
FitRequest of_light(FitRequest request) {
    request.space = TargetSpace::linear;
    request.surface = SurfaceLookup::nearest;
    return request;
}

constexpr const char* no_model = "none";

/// Throws UserError for a dataset that no light basis can be fitted to.
void require_lit(const Dataset& dataset) {
    require_lights(dataset);
    if (!lamps_have_all_colours(dataset))
        throw UserError(
            fmt::format("{}: some lamps send no light of a colour, and a light basis has the channels share "
                        "their numbers; fit a reflectance model, such as lafortune",
                        dataset.folder.string()));
}

/// Of a texel.
size_t numbers_of(const FitRequest& request) {
    const TexelModel* underneath = find_texel_model(request.own<LightBasisOptions>().underneath);
    return size_t(options_of(request).rank) + (underneath ? size_t(underneath->parameters) : 0);
}

/// What a light basis adds to: a reflectance model that was fitted before. Nothing unless the request names one.
class Underneath {
public:
    Underneath(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
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
    const TexelModel* model() const { return fit_.options.model; }
    LightUnderneath light() const {
        if (!safe_) return {};
        return [this](uint32_t texel, const View& view) { return safe_->colour_of(texel, view, 1); };
    }
    /// [texels][parameters]
    const std::vector<float>& parameters() const { return fit_.parameters; }

private:
    ReflectanceFit fit_;
    std::unique_ptr<const SafeRelighting> safe_;
};

/// Fills what is solved of each texel.
void solve_texels(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
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

FinishedFit fit_light_basis(const Dataset& dataset, const FitRequest& asked) {
    asked.check();
    require_lit(dataset);
    const FitRequest request = of_light(asked);
    const Stopwatch clock;
    FinishedFit out;
    auto atlas = texel_atlas(dataset, request.model.surface_side);
    const std::vector<uint32_t> views = fitted_views(dataset, request);
    const SharedTexels samples = distribute_texels(dataset, request, views);
    require_seen(samples.source->sample_count() > 0, dataset, request);
    out.run.times.distribution = samples.seconds;
    const Stopwatch optimizing;
    double learning_s = 0;
    LightBasisFit fit = fit_lamp_texels(dataset, *atlas, views, samples, request, &out.run, &learning_s);
    out.times_json = nlohmann::json{{"learning_s", learning_s}}.dump();
    out.note = fmt::format("basis learned in {:.1f} s, ", learning_s);
    out.run.times.optimization = optimizing.wall_s();
    describe_request(request, fit);
    set_dataset(fit, dataset);
    out.run.times.total = clock.wall_s();
    out.fit = {FittedLightBasis{std::move(fit), std::move(atlas)}, dataset};
    return out;
}

/// The basis is learned once, from few texels of the whole; parts go on from there.
class DividedLightBasis final : public DividedTexels {
public:
    DividedLightBasis(const Dataset& dataset, const FitRequest& request)
        : DividedTexels(dataset, request, texel_atlas(dataset, request.model.surface_side), numbers_of(request)) {}

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
        solve_texels(part.dataset, *atlas, views, samples, underneath, part.request, fit, run);
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
        return DividedTexels::held_bytes() + uint64_t(options_of(request_).blocks) * 3 * most_reference_lamps *
                                                 uint64_t(1 + options_of(request_).rank) * sizeof(float);
    }

    void add(const PartResult& result, const std::string& name) override {
        DividedTexels::add(result, name);
        try {
            LightBasis& basis = whole_.basis;
            if (basis.numbers.empty()) {
                basis = described_light_basis(result.own_json);
                basis.numbers = result.own;
            }
            if (basis.numbers.size() != basis.cubes.size() * basis.block_size() || basis.numbers != result.own ||
                description_of(basis) != result.own_json)
                throw std::runtime_error("another basis");
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
        const LightBasisOptions o = options_of(request_);
        return std::min<uint64_t>(atlas_->texel_count(),
                                  uint64_t(o.texels) + uint64_t(o.block_texels) * uint64_t(o.blocks));
    }
    void learn(FitRun& run) const {
        const Stopwatch clock;
        const std::vector<bool> texels = learned_from(*dataset_, *atlas_, options_of(request_));
        const Distributors all = make_distributors(*atlas_, request_);
        std::vector<OnlyTexels> only;
        for (Distributor* worker : all.workers()) only.emplace_back(*worker, texels);
        std::vector<Distributor*> workers;
        for (OnlyTexels& worker : only) workers.push_back(&worker);
        SharedTexels samples;
        samples.source = gather_texels(*dataset_, *atlas_, views_, workers);
        run.times.distribution += clock.wall_s();
        const Stopwatch learning;
        const Underneath underneath(*dataset_, *atlas_, views_, samples, request_);
        basis_ =
            learn_light_basis(*dataset_, *atlas_, views_, *samples.source, options_of(request_), underneath.light());
        run.times.optimization += learning.wall_s();
    }

    mutable std::optional<LightBasis> basis_;
    LightBasisFit whole_;  ///< of parts that were added
};

Plan plan_light_basis(const Dataset& dataset, const FitRequest& request, size_t most_views) {
    request.check();
    require_lights(dataset);
    const LightBasisOptions options = options_of(request);
    const auto atlas = texel_atlas(dataset, request.model.surface_side);
    const uint64_t texels = atlas->texel_count(), n = numbers_of(request),
                   basis = uint64_t(options.blocks) * 3 * most_reference_lamps * uint64_t(options.rank + 1);
    Plan plan;
    plan.disk.push_back(
        {"maps",
         fmt::format("{} x {} pixels x {} floats, before they are compressed", atlas->width(), atlas->height(), n + 4),
         n + 4, uint64_t(atlas->width()) * uint64_t(atlas->height()) * 4 * (n + 4)});
    plan.disk.push_back(
        {"basis, about",
         fmt::format("{} blocks x {} floats at most", options.blocks, 3 * most_reference_lamps * (options.rank + 1)),
         basis, basis * sizeof(float)});
    std::vector<PlanRow>& rows = plan.memory;
    rows.push_back(plan.disk.back());
    const uint64_t samples = estimate_samples(dataset, *atlas, request, most_views).samples;
    rows.push_back({"samples, about", fmt::format("pixels in texels x {} bytes", sizeof(TexelRadiance)), samples,
                    samples * sizeof(TexelRadiance)});
    rows.push_back({"results", fmt::format("{} texels x ({} parameters, 4 figures)", texels, n), texels * n,
                    texels * 4 * (n + 4)});
    if (request.on_engine(EngineKind::compute))
        rows.push_back({"texels for the device", "some at a time, there and here", 1, bytes_on_device()});
    return plan;
}

/// At the pixels of a view [height][width], in linear light: what a standard deviation on the curve makes of the
/// colour.
void show_error_bars(const FittedLightBasis& m, const Contestant& colours, const Eigen::Matrix3f& inward,
                     const View& view, const std::vector<RasterPixel>& pixels, std::vector<ErrorBar>& bars) {
    const TexelOfPixel texel_of(*m.atlas);
    const LightBasis& basis = m.fit.basis;
    LightBasisSolver solver(basis);
    std::vector<float> rgb;
    colours.shade(view, pixels, rgb, 0);
    bars.assign(pixels.size(), {});
    for (size_t i = 0; i < pixels.size(); ++i) {
        if (pixels[i].triangle == no_triangle) continue;
        const uint32_t texel = texel_of(pixels[i]);
        const Vec3f position = m.atlas->position(texel);
        const TexelShading::Place place{position.cast<double>(), basis.frame_of(m.atlas->normal(texel))};
        const TexelShading::Lit lit = TexelShading::lit(place, view);
        const Vec3f value = basis.value_of(Vec3f::Map(&rgb[3 * i]), lit.irradiance);
        const auto in_light = [&](const Vec3f& deviation) -> Vec3f {
            return (basis.light_of(value + deviation, lit.irradiance) -
                    basis.light_of(value - deviation, lit.irradiance)) /
                   2;
        };
        if (m.error_bars->noise[texel] == 0) {  // nothing is known of it
            bars[i].fit.setConstant(INFINITY);
            continue;
        }
        const Vec3f direction = place.frame.to_local(inward * view.light->direction_from(place.position).cast<float>());
        bars[i].fit = in_light(m.error_bars->of_value(texel, basis.block_at(position), direction, solver));
        bars[i].noise = in_light(Vec3f::Constant(m.error_bars->noise[texel]));
    }
}

void check_underneath(const std::string& name) {
    std::vector<std::string> names = {no_model};
    for (const TexelModel* model : texel_models()) names.emplace_back(model->name);
    if (std::ranges::find(names, name) == names.end()) reject_name("underneath", name, names);
}

}  // namespace

LightBasisFit fit_lamp_texels(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                              const SharedTexels& samples, const FitRequest& request, FitRun* run, double* learning_s) {
    LightBasisFit fit;
    fit.surface_side = request.model.surface_side;
    const Underneath underneath(dataset, atlas, views, samples, request);
    const Stopwatch learning;
    fit.basis = learn_light_basis(dataset, atlas, views, *samples.source, options_of(request), underneath.light(),
                                  request.journal.get());
    if (learning_s) *learning_s = learning.wall_s();
    FitRun ignored;
    solve_texels(dataset, atlas, views, samples, underneath, request, fit, run ? *run : ignored);
    return fit;
}

std::string description_of(const FittedLightBasis& m) {
    const LightBasis& basis = m.fit.basis;
    return fmt::format("light basis of rank {} in {} blocks of the surface{}, {} numbers in each of {} texels",
                       basis.rank, basis.cubes.size(),
                       m.fit.underneath ? fmt::format(" upon {}", m.fit.underneath->name) : "", m.fit.numbers(),
                       m.fit.problem_count());
}

Contestant contestant_of(const FittedLightBasis& m, const Dataset& dataset) {
    const std::vector<uint32_t> training = fitted_views(dataset, m.fit);
    Contestant out = contestant_of(m.fit, *m.atlas, dataset, training);
    if (m.error_bars)
        out.error_bars = [&m, &dataset, training, colours = out](const View& view, const auto& pixels,
                                                                 std::vector<ErrorBar>& bars) {
            show_error_bars(m, colours, turn_inside(dataset, training, view), view, pixels, bars);
        };
    return out;
}

void find_error_bars(FittedLightBasis& m, const Dataset& dataset, std::span<const View>) {
    const auto views = fitted_views(dataset, m.fit);
    FitRequest request;
    request.model.surface_side = m.fit.surface_side;
    const SharedTexels samples = distribute_texels(dataset, request, views);
    std::optional<ReflectanceFit> underneath;
    std::optional<SafeRelighting> safe;
    LightUnderneath light;
    if (m.fit.underneath) {
        underneath = underneath_of(m.fit);
        safe.emplace(dataset, views, *m.atlas, *underneath);
        light = [&safe](uint32_t texel, const View& view) { return safe->colour_of(texel, view, 1); };
    }
    const TexelLightReader reader(dataset, *m.atlas, views, m.fit.basis, light);
    m.error_bars = std::make_shared<LightErrorBars>(m.fit, *m.atlas, *samples.source, reader);
}

void write_error_bars(const std::filesystem::path& folder, const FittedLightBasis& m, const Dataset&) {
    if (m.error_bars) write_error_bars(folder, *m.atlas, m.fit, *m.error_bars);
}

Fitted baseline_of(const FittedLightBasis& m, const Dataset& dataset) {
    return lambertian(dataset, m.fit.surface_side, validation_of(m.fit));
}

std::vector<FitArray> arrays_of(const FittedLightBasis& m, const Dataset&) {
    return {FitArray::of("texels", "texel, function of the basis, then parameter of the model underneath",
                         m.fit.parameters.data(), {m.fit.problem_count(), uint64_t(m.fit.numbers())})};
}

void export_parameters(const FittedLightBasis&, const Dataset&, ProblemFolder&) {
    throw UserError("a light basis has no problems to export; choose lfm or a texel-local model");
}

const Family light_bases = {
    .name = "light bases",
    .owns = [](const std::string& model) { return model == light_basis_name; },
    .models = [] { return std::vector<std::string>{light_basis_name}; },
    .help = "lightbasis is colours by lamp direction in each texel, on a basis that is learned over the surface",
    .options =
        [] {
            return by_view_options(
                {rows::number("numbers", 0, rows::own(&LightBasisOptions::rank), limits::light_rank,
                              "of each texel: functions of the lamp's direction"),
                 rows::choice<ValueCurve>(
                     "curve", 0, rows::own(&LightBasisOptions::curve), value_curves(),
                     "what of light is fitted: as sRGB pictures store it, its square root, or light itself"),
                 rows::text("underneath", 0, rows::own(&LightBasisOptions::underneath), "none, or a texel-local model",
                            "what the basis adds to: a reflectance model that is fitted first", check_underneath),
                 noise_option(), blocks_option()});
        },
    .has_error_bars = true,
    .kind = ModelKind::by_light,
    .facts = [](const Solver& solver) -> std::optional<SolverFacts> {
        if (solver.solve == solve_stream) return SolverFacts{.on_engine = true};
        return {};
    },
    .streamed = [](const FitRequest&) -> std::optional<TargetSpace> { return std::nullopt; },
    .choose = [](const Given&, const Dataset&, const FitRequest&) -> std::optional<Chosen> { return {}; },
    .resolve_options =
        [](const Given& given, const Dataset& dataset, FitRequest& request) {
            if (!given("--surface-side") && !dataset.has_grid()) request.model.surface_side = reflectance_side(dataset);
            if (!given("--noise")) request.own<ByViewOptions>().noise = LightBasisOptions().noise;
            if (!given("--blocks"))
                request.own<ViewBasisOptions>().blocks =
                    light_blocks(*texel_atlas(dataset, request.model.surface_side));
        },
    .candidates = [](const Dataset& dataset) -> std::vector<TuneCandidate> {
        if (!dataset.light_moves()) return {};
        return {{{{{"model", light_basis_name}}},
                 {{"numbers", {"9", "18", "27", "54", "108"}},
                  {"curve", {"srgb", "root", "linear"}},
                  noise_ladder(),
                  {"blocks", {"1", "4", "16", "64"}}}}};
    },
    .plan = plan_light_basis,
    .fit = fit_light_basis,
    .divide = [](const Dataset& dataset, const FitRequest& request) -> std::unique_ptr<Divided> {
        request.check();
        require_lit(dataset);
        return std::make_unique<DividedLightBasis>(dataset, of_light(request));
    },
    .export_problems =
        [](const Dataset&, const FitRequest&, ProblemFolder&) {
            throw UserError("a light basis has no problems to export; choose lfm or a texel-local model");
        },
    .open =
        [](const std::filesystem::path& folder, const std::filesystem::path& moved_to) {
            StoredLightBasis stored = read_light_basis(folder, moved_to);
            return Fitted{FittedLightBasis{std::move(stored.fit), std::move(stored.atlas)}, std::move(stored.dataset)};
        },
};

}  // namespace radiafit::fits
