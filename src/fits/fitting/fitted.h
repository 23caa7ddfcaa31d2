#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "eval/judge.h"
#include "eval/safe_views.h"
#include "fit/fit_folder.h"
#include "fitting/fit_array.h"
#include "fitting/problem_folder.h"
#include "lightbasis/light_error_bars.h"
#include "sg/sg_fit.h"
#include "viewbasis/view_basis_fit.h"

namespace radiafit {
class AllErrorBars;
}  // namespace radiafit

/// A fit as a value, whatever its family. What is asked of one is a free function here. A ring around this one that
/// shows a fit in another way (a page, a material) writes an overload for each of the five and calls it by
/// std::visit().
namespace radiafit::fits {

struct LightFieldErrorBars;

struct FittedLightField {
    LightFieldFit fit;
    std::shared_ptr<const LightFieldErrorBars> error_bars = {};  ///< none until find_error_bars()
    std::vector<int64_t> first_texels = {};                      ///< of arrays_of(), once it was called
};

struct FittedReflectance {
    ReflectanceFit fit;
    std::unique_ptr<Atlas> atlas;
    std::shared_ptr<const AllErrorBars> error_bars = {};  ///< none until find_error_bars()
};

/// Colours by view direction, texel by texel.
template <class Fit>
struct FittedByView {
    Fit fit;
    std::unique_ptr<TriangleAtlas> atlas;
};
using FittedViewBasis = FittedByView<ViewBasisFit>;
using FittedSg = FittedByView<SgFit>;

/// Colours by lamp direction, texel by texel.
struct FittedLightBasis {
    LightBasisFit fit;
    std::unique_ptr<Atlas> atlas;
    std::shared_ptr<const LightErrorBars> error_bars = {};  ///< none until find_error_bars()
};

/// The dataset that was fitted: the caller's, who keeps it; or one that the fit owns.
class FittedDataset {
public:
    FittedDataset() = default;
    FittedDataset(const Dataset& dataset) : dataset_(&dataset) {}
    FittedDataset(std::unique_ptr<Dataset> dataset) : opened_(std::move(dataset)), dataset_(opened_.get()) {}
    /// To be opened when it is first asked for. moved_to: where it is now; empty: where the fit says.
    explicit FittedDataset(std::filesystem::path moved_to) : moved_to_(std::move(moved_to)) {}

    /// Throws UserError where it can't be opened, or is another than the one that was fitted.
    const Dataset& of(const FitRecord& fit);

private:
    std::filesystem::path moved_to_;
    std::unique_ptr<Dataset> opened_;
    const Dataset* dataset_ = nullptr;
};

struct Fitted {
    std::variant<FittedLightField, FittedReflectance, FittedViewBasis, FittedSg, FittedLightBasis> model;
    FittedDataset data;
    /// Of safe_views_of(), once it was called: they are of the fit where it was then.
    struct {
        const Fitted* of = nullptr;
        std::shared_ptr<const SafeViews> views = {};
    } bounds = {};

    FitRecord& record();
    const FitRecord& record() const;
    const Dataset& dataset() { return data.of(record()); }
};

/// Numbers that it stores: of a light field map three for each texel and term, of others all parameters; of bases that
/// are learned over the surface, theirs as well.
size_t number_count(const Fitted& fitted);
/// "lafortune, 9 parameters in each of 4096 texels"
std::string description_of(const Fitted& fitted);
/// What a fit of colours by view direction is bounded by off its photographs; null for others. `fitted` must outlive
/// it, and stay where it is.
std::shared_ptr<const SafeViews> safe_views_of(Fitted& fitted);
/// For the judge and for renders, bounded by that; `fitted` must outlive it, and stay where it is.
Contestant contestant_of(Fitted& fitted);
/// The trivial baseline, of the views, sides, space and samples that this fit used. The dataset must outlive it.
Fitted baseline_of(Fitted& fitted);
const char* baseline_name(const Fitted& fitted);
/// Empty unless the dataset is synthetic: its materials, and how far the fit is from their parameters.
SurfaceParts surface_parts(Fitted& fitted);
std::vector<MaterialErrors> truth_errors(Fitted& fitted);
/// Whether it shows the surface under any lamp.
bool takes_light(const Fitted& fitted);
/// Finds how far noise moves the fit (cpu/texel_covariance.h, cpu/vertex_covariance.h), which truth_errors() and, of
/// the views that will be shown, contestant_of() say from then on. Throws UserError where a model has no error bars.
void find_error_bars(Fitted& fitted, std::span<const View> shown);
/// Writes error bars as maps, once they are found; until then nothing.
void write_error_bars(const std::filesystem::path& folder, Fitted& fitted);
/// As write_fit() of fit/fit_folder.h.
void write_fit(const std::filesystem::path& folder, Fitted& fitted,
               const std::function<void(const std::filesystem::path& temporary_folder)>& add_files);
/// Its parameters where they lie, valid as long as the fit is, and stays where it is.
std::vector<FitArray> arrays_of(Fitted& fitted);
/// Its parameters, laid out as Family::export_problems() lays out where fits begin. Throws UserError for a model that
/// has no problems to export.
void export_parameters(Fitted& fitted, ProblemFolder& out);

}  // namespace radiafit::fits
