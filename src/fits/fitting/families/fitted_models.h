#pragma once
#include "base/error.h"
#include "fitting/family.h"

/// What each family answers to the questions of fitting/fitted.h, which has one function for all. A template stands for
/// the families that have nothing special to say.
namespace radiafit::fits {

std::string description_of(const FittedLightField& m);
std::string description_of(const FittedReflectance& m);
std::string description_of(const FittedViewBasis& m);
std::string description_of(const FittedSg& m);
std::string description_of(const FittedLightBasis& m);

Contestant contestant_of(const FittedLightField& m, const Dataset& dataset);
Contestant contestant_of(const FittedReflectance& m, const Dataset& dataset);
Contestant contestant_of(const FittedLightBasis& m, const Dataset& dataset);
template <class Fit>
Contestant contestant_of(const FittedByView<Fit>& m, const Dataset&) {
    return contestant_of(m.fit, *m.atlas);
}

template <class Model>
std::shared_ptr<const SafeViews> safe_views_of(const Model&, const Dataset&) {
    return nullptr;
}
std::shared_ptr<const SafeViews> safe_views_of(const FittedLightField& m, const Dataset& dataset);
template <class Fit>
std::shared_ptr<const SafeViews> safe_views_of(const FittedByView<Fit>& m, const Dataset& dataset) {
    const std::shared_ptr<const TriangleAtlas> not_owned(std::shared_ptr<void>(), m.atlas.get());
    return std::make_shared<const SafeViews>(dataset, fitted_views(dataset, m.fit), not_owned, m.fit.surface,
                                             contestant_of(m.fit, *m.atlas));
}

Fitted baseline_of(const FittedLightField& m, const Dataset& dataset);
Fitted baseline_of(const FittedReflectance& m, const Dataset& dataset);
Fitted baseline_of(const FittedLightBasis& m, const Dataset& dataset);
template <class Fit>
Fitted baseline_of(const FittedByView<Fit>& m, const Dataset& dataset) {
    LfmOptions sides;
    sides.surface_side = m.fit.surface_side;
    return mean_colours(dataset, m.fit, sides);
}

template <class Model>
SurfaceParts surface_parts(const Model&, const Dataset&) {
    return {};
}
SurfaceParts surface_parts(const FittedReflectance& m, const Dataset& dataset);
template <class Model>
std::vector<MaterialErrors> truth_errors(const Model&, const Dataset&) {
    return {};
}
std::vector<MaterialErrors> truth_errors(const FittedReflectance& m, const Dataset& dataset);

void find_error_bars(FittedLightField& m, const Dataset& dataset, std::span<const View> shown);
void find_error_bars(FittedReflectance& m, const Dataset& dataset, std::span<const View> shown);
void find_error_bars(FittedLightBasis& m, const Dataset& dataset, std::span<const View> shown);
template <class Model>
void find_error_bars(Model&, const Dataset&, std::span<const View>) {
    throw UserError("--covariance: this model has no error bars; fit lfm or a model for lamps, such as lafortune");
}

void write_error_bars(const std::filesystem::path& folder, const FittedLightField& m, const Dataset& dataset);
void write_error_bars(const std::filesystem::path& folder, const FittedReflectance& m, const Dataset& dataset);
void write_error_bars(const std::filesystem::path& folder, const FittedLightBasis& m, const Dataset& dataset);
template <class Model>
void write_error_bars(const std::filesystem::path&, const Model&, const Dataset&) {}

std::vector<FitArray> arrays_of(FittedLightField& m, const Dataset& dataset);
std::vector<FitArray> arrays_of(const FittedReflectance& m, const Dataset& dataset);
std::vector<FitArray> arrays_of(const FittedViewBasis& m, const Dataset& dataset);
std::vector<FitArray> arrays_of(const FittedSg& m, const Dataset& dataset);
std::vector<FitArray> arrays_of(const FittedLightBasis& m, const Dataset& dataset);

void export_parameters(const FittedLightField& m, const Dataset& dataset, ProblemFolder& out);
void export_parameters(const FittedReflectance& m, const Dataset& dataset, ProblemFolder& out);
void export_parameters(const FittedViewBasis& m, const Dataset& dataset, ProblemFolder& out);
void export_parameters(const FittedSg& m, const Dataset& dataset, ProblemFolder& out);
void export_parameters(const FittedLightBasis& m, const Dataset& dataset, ProblemFolder& out);

}  // namespace radiafit::fits
