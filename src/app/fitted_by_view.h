#pragma once
#include <fmt/format.h>

#include "app/family.h"
#include "app/fit_options.h"
#include "app/parts.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/wording.h"
#include "publish/pages.h"
#include "samples/interpolated_samples.h"

/// What the families of colours by view direction, texel by texel, have in common: `Fit` is a FitRecord with
/// surface_side and parameters in a TriangleAtlas, with write_fit() and contestant_of(); `Words` says describe(fit,
/// atlas), and what it calls itself where it has no problems to export.
namespace radiafit {

template <class Words>
[[noreturn]] void refuse_export() {
    throw UserError(fmt::format("{} no problems to export; choose lfm or a texel-local model", Words::have));
}

template <class Fit, class Words>
class FittedByView : public Fitted {
public:
    FittedByView(Fit fit, std::unique_ptr<TriangleAtlas> atlas, const Dataset& dataset)
        : fit_(std::move(fit)), atlas_(std::move(atlas)), dataset_(&dataset) {}
    /// Stored: fit, atlas and dataset, as they were read.
    template <class Stored>
    explicit FittedByView(Stored stored)
        : fit_(std::move(stored.fit)),
          atlas_(std::move(stored.atlas)),
          own_(std::move(stored.dataset)),
          dataset_(own_.get()) {}

    FitRecord& record() override { return fit_; }
    const Dataset& dataset() override { return *dataset_; }
    std::string description() const override { return Words::describe(fit_, *atlas_); }
    Contestant contestant() override { return contestant_of(fit_, *atlas_); }
    std::unique_ptr<Fitted> baseline() override {
        LfmOptions sides;
        sides.surface_side = fit_.surface_side;
        return mean_colours(dataset(), fit_, sides);
    }
    const char* baseline_name() const override { return "mean colour per texel"; }
    PageModel page() override { return page_model_of(fit_, *atlas_); }
    void write(const std::filesystem::path& folder,
               const std::function<void(const std::filesystem::path&)>& add_files) override {
        write_fit(folder, fit_, *atlas_, add_files);
    }
    void export_parameters(ProblemFolder&) override { refuse_export<Words>(); }

private:
    Fit fit_;
    std::unique_ptr<TriangleAtlas> atlas_;
    std::unique_ptr<Dataset> own_;
    const Dataset* dataset_;
};

/// solve(atlas, samples, fit, out) fills the fit's problems and parameters, and what `out` tells of them.
template <class Fit, class Words, class Solve>
FinishedFit fit_by_view(const Dataset& dataset, const FitRequest& request, const Solve& solve) {
    request.check();
    require_light_field(dataset);
    const Stopwatch clock;
    FinishedFit out;
    Fit fit;
    fit.surface_side = request.model.surface_side;
    auto atlas = std::make_unique<TriangleAtlas>(dataset.mesh, fit.surface_side);
    const SampleList samples = interpolated_samples(dataset, *atlas, fitted_views(dataset, request), request.space);
    require_seen(!samples.samples.empty(), dataset, request);
    out.run.times.distribution = clock.wall_s();
    const Stopwatch solving;
    solve(*atlas, samples, fit, out);
    out.run.times.optimization = solving.wall_s();
    describe_request(request, fit);
    set_dataset(fit, dataset);
    out.run.times.total = clock.wall_s();
    out.fit = std::make_unique<FittedByView<Fit, Words>>(std::move(fit), std::move(atlas), dataset);
    return out;
}

/// Each texel stands alone: finer ones show more.
inline void settle_by_view(const std::function<bool(const char*)>& given, const Dataset&, FitRequest& request) {
    if (!given("--surface-side")) request.model.surface_side = 12;
}

}  // namespace radiafit
