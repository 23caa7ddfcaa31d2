// What a fitted light field map answers.
#include <fmt/format.h>

#include <algorithm>

#include "cpu/vertex_covariance.h"
#include "fit/error_bar_maps.h"
#include "fitting/families/fitted_models.h"
#include "fitting/fit_options.h"
#include "fitting/solvers/solver.h"

namespace radiafit::fits {

struct LightFieldErrorBars {
    const TriangleAtlas atlas;
    const std::vector<Vec3d> eyes;  ///< of the views that will be shown
    const AllVertexErrorBars of;

    LightFieldErrorBars(const Dataset& dataset, TriangleAtlas its_atlas, const SampleList& samples,
                        const LfmOptions& options, std::span<const float> parameters, std::vector<Vec3d> its_eyes)
        : atlas(std::move(its_atlas)),
          eyes(std::move(its_eyes)),
          of(dataset, atlas, VertexRings(dataset.mesh), samples, options, parameters, eyes) {}

    /// At the pixels of a view [height][width].
    void at(const View& view, const std::vector<RasterPixel>& pixels, std::vector<ErrorBar>& bars) const {
        const auto eye = std::ranges::find(eyes, view.camera.center());
        if (eye == eyes.end()) throw std::logic_error("error bars of a view that was not to be shown");
        bars.assign(pixels.size(), {});
        for (size_t i = 0; i < pixels.size(); ++i) {
            const RasterPixel& pixel = pixels[i];
            if (pixel.triangle == no_triangle) continue;
            const uint32_t local = atlas.local_at(pixel.triangle, pixel.b1, pixel.b2);
            bars[i].fit = of.of_value(size_t(eye - eyes.begin()), pixel.triangle, local);
            bars[i].noise = of.noise_at(pixel.triangle, local);
        }
    }
};

std::string description_of(const FittedLightField& m) {
    const LfmOptions& o = m.fit.options;
    const int least = o.sides ? *std::ranges::min_element(*o.sides) : o.surface_side;
    const std::string side =
        o.sides ? fmt::format("sides {} to {}", least, o.surface_side) : fmt::format("side {}", o.surface_side);
    return fmt::format("light field map of {} terms, surface maps of {}, view maps of side {}", o.terms, side,
                       o.view_side);
}

Contestant contestant_of(const FittedLightField& m, const Dataset& dataset) {
    Contestant out = contestant_of(m.fit, dataset.mesh);
    if (m.error_bars)
        out.error_bars = [error_bars = m.error_bars](const View& view, const auto& pixels,
                                                     std::vector<ErrorBar>& bars) {
            error_bars->at(view, pixels, bars);
        };
    return out;
}

std::shared_ptr<const SafeViews> safe_views_of(const FittedLightField& m, const Dataset& dataset) {
    if (!facts_of(fitted_request(m.fit)).has_view_maps()) return nullptr;
    return std::make_shared<const SafeViews>(
        dataset, fitted_views(dataset, m.fit),
        std::make_shared<const TriangleAtlas>(surface_atlas(dataset.mesh, m.fit.options)), m.fit.surface,
        contestant_of(m.fit, dataset.mesh));
}

void find_error_bars(FittedLightField& m, const Dataset& dataset, std::span<const View> shown) {
    const LightFieldFit& fit = m.fit;
    const FitRequest fitted = fitted_request(fit);
    LfmOptions options = fit.options;
    options.loss = fitted.model.loss;
    if (!facts_of(fitted).objective) options.lambda_surface = options.lambda_view = options.mu = 0;
    auto atlas = surface_atlas(dataset.mesh, options);
    FitRequest request;
    request.space = fit.space;
    const SharedSamples samples = distribute(dataset, atlas, request, fitted_views(dataset, fit));
    std::vector<Vec3d> eyes;
    for (const View& view : shown) eyes.push_back(view.camera.center());
    m.error_bars = std::make_shared<LightFieldErrorBars>(dataset, std::move(atlas), samples.list, options,
                                                         fit.parameters, std::move(eyes));
}

void write_error_bars(const std::filesystem::path& folder, const FittedLightField& m, const Dataset& dataset) {
    if (!m.error_bars) return;
    const AllVertexErrorBars& bars = m.error_bars->of;
    write_error_bars(folder, m.fit, dataset.mesh, {bars.deviation, bars.noise, bars.deficient});
}

Fitted mean_colours(const Dataset& dataset, const FitRecord& like, const LfmOptions& sides) {
    FitRequest mean;
    mean.set("solver", "mean");
    mean.space = like.space;
    mean.surface = like.surface;
    mean.model = sides;
    mean.validation = validation_of(like);
    return {FittedLightField{solve(dataset, mean).fit}, dataset};
}

Fitted baseline_of(const FittedLightField& m, const Dataset& dataset) {
    return mean_colours(dataset, m.fit, m.fit.options);
}

std::vector<FitArray> arrays_of(FittedLightField& m, const Dataset& dataset) {
    const LightFieldFit& fit = m.fit;
    const uint64_t terms = uint64_t(fit.options.terms), texel = 4 * terms;  // red, green, blue, and one lane of padding
    std::vector<int64_t>& first = m.first_texels;
    if (first.empty()) {
        const LfmLayout layout(VertexRings(dataset.mesh), surface_atlas(dataset.mesh, fit.options),
                               fit.options.view_side, fit.options.terms);
        for (size_t v = 0; v < layout.problem_count(); ++v) {
            first.push_back(int64_t(layout.offset(v) / texel));
            first.push_back(int64_t(layout.view_offset(v) / texel));
        }
    }
    return {FitArray::of(
                "texels",
                "texel, term, channel: of each vertex its surface maps, by the triangles around it, then its view map",
                fit.parameters.data(), {fit.parameters.size() / texel, terms, 3}, {texel, 4, 1}),
            FitArray::of("first_texels", "vertex: where its surface maps begin, and where its view map", first.data(),
                         {first.size() / 2, 2})};
}

void export_parameters(const FittedLightField& m, const Dataset& dataset, ProblemFolder& out) {
    export_parameters(m.fit, dataset.mesh, out);
}

}  // namespace radiafit::fits
