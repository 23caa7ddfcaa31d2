#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/family.h"
#include "app/fit_options.h"
#include "app/parts.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/wording.h"
#include "samples/interpolated_samples.h"
#include "viewbasis/solve_view_basis.h"
#include "viewbasis/view_basis_fit.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

class FittedViewBasis : public Fitted {
public:
    FittedViewBasis(ViewBasisFit fit, std::unique_ptr<TriangleAtlas> atlas, const Dataset& dataset)
        : fit_(std::move(fit)), atlas_(std::move(atlas)), dataset_(&dataset) {}
    explicit FittedViewBasis(StoredViewBasis stored)
        : fit_(std::move(stored.fit)),
          atlas_(std::move(stored.atlas)),
          own_(std::move(stored.dataset)),
          dataset_(own_.get()) {}

    FitRecord& record() override { return fit_; }
    const Dataset& dataset() override { return *dataset_; }
    std::string description() const override {
        return fmt::format("view basis of rank {} in {} blocks of the surface, {} numbers in each of {} texels",
                           fit_.basis.rank, fit_.basis.blocks.size(), 3 * fit_.basis.rank, atlas_->used_texels());
    }
    Contestant contestant() override { return contestant_of(fit_, *atlas_); }
    std::unique_ptr<Fitted> baseline() override {
        LfmOptions sides;
        sides.surface_side = fit_.surface_side;
        return mean_colours(dataset(), fit_, sides);
    }
    const char* baseline_name() const override { return "mean colour per texel"; }
    void write(const fs::path& folder, const std::function<void(const fs::path&)>& add_files) override {
        write_fit(folder, fit_, *atlas_, add_files);
    }
    void export_parameters(ProblemFolder&) override {
        throw UserError("a view basis has no problems to export; choose lfm or a texel-local model");
    }

private:
    ViewBasisFit fit_;
    std::unique_ptr<TriangleAtlas> atlas_;
    std::unique_ptr<Dataset> own_;
    const Dataset* dataset_;
};

FinishedFit fit_view_basis(const Dataset& dataset, const FitRequest& request) {
    request.check();
    require_light_field(dataset);
    const Stopwatch clock;
    FinishedFit out;
    ViewBasisFit fit;
    fit.surface_side = request.model.surface_side;
    auto atlas = std::make_unique<TriangleAtlas>(dataset.mesh, fit.surface_side);
    const SampleList samples = interpolated_samples(dataset, *atlas, fitted_views(dataset, request), request.space);
    require_seen(!samples.samples.empty(), dataset, request);
    out.run.times.distribution = clock.wall_s();
    const Stopwatch solving;
    fit.basis = learn_view_basis(dataset, *atlas, samples, request.view_basis);
    const double learning = solving.wall_s();
    ViewBasisSolution solution = solve_view_basis(dataset, *atlas, samples, fit.basis);
    out.run.times.optimization = solving.wall_s();
    fit.parameters = std::move(solution.parameters);
    fit.samples = std::move(solution.samples);
    fit.error = std::move(solution.error);
    fit.iterations.assign(fit.samples.size(), 0);
    for (const uint32_t seen : fit.samples) fit.status.push_back(seen > 0 ? Status::stationary : Status::no_samples);
    describe_request(request, fit);
    set_dataset(fit, dataset);
    out.times_json = nlohmann::json{{"learning_s", learning}}.dump();
    out.note = fmt::format("basis learned in {:.1f} s, ", learning);
    out.run.times.total = clock.wall_s();
    out.fit = std::make_unique<FittedViewBasis>(std::move(fit), std::move(atlas), dataset);
    return out;
}

}  // namespace

const Family view_bases = {
    .name = "view bases",
    .owns = [](const std::string& model) { return model == view_basis_name; },
    .models = [] { return std::vector<std::string>{view_basis_name}; },
    .help = "viewbasis is colours by view direction in each texel, on a basis that is learned over the surface",
    .uses = [](const Solver& solver) -> uint32_t {
        return solver.solve == solve_stream ? use::sides | use::space | use::view_basis : 0;
    },
    .streamed = [](const FitRequest& request) -> std::optional<TargetSpace> { return request.space; },
    .settle =
        [](const auto& given, const Dataset&, FitRequest& request) {
            if (!given("--surface-side")) request.model.surface_side = 12;  // each texel stands alone: finer shows more
        },
    .plan = plan_view_basis,
    .fit = fit_view_basis,
    .divide = [](const Dataset&, const FitRequest&) -> std::unique_ptr<Divided> {
        throw UserError(fmt::format("a view basis is fitted in one piece; leave out {} and {}", option_name("memory"),
                                    option_name("shard")));
    },
    .export_problems =
        [](const Dataset&, const FitRequest&, ProblemFolder&) {
            throw UserError("a view basis has no problems to export; choose lfm or a texel-local model");
        },
    .open = [](const fs::path& folder, const fs::path& moved_to) -> std::unique_ptr<Fitted> {
        return std::make_unique<FittedViewBasis>(read_view_basis(folder, moved_to));
    },
};

}  // namespace radiafit
