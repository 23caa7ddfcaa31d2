#include "fitting/fitted.h"

#include "base/atomic_file.h"
#include "fitting/families/fitted_models.h"
#include "fitting/family.h"
#include "ownmodel/own_model.h"

namespace radiafit::fits {
namespace {

template <class Model>
void add_model_text(const Model&, const std::filesystem::path&) {}
/// So that the fit can be opened where nobody has the file that the model came from.
void add_model_text(const FittedReflectance& m, const std::filesystem::path& folder) {
    const std::string text = text_of_model(m.fit.options.model->name);
    if (!text.empty()) write_file(folder / model_text_name, text);
}

}  // namespace

const Dataset& FittedDataset::of(const FitRecord& fit) {
    if (!dataset_) {
        opened_ = std::make_unique<Dataset>(open_fitted_dataset(fit, moved_to_));
        dataset_ = opened_.get();
    }
    return *dataset_;
}

FitRecord& Fitted::record() {
    return std::visit([](auto& m) -> FitRecord& { return m.fit; }, model);
}
const FitRecord& Fitted::record() const {
    return std::visit([](const auto& m) -> const FitRecord& { return m.fit; }, model);
}

size_t number_count(const Fitted& f) {
    const auto* of_vertices = std::get_if<FittedLightField>(&f.model);
    if (of_vertices) return of_vertices->fit.parameters.size() / 4 * 3;  // the fourth of each pads
    return std::visit(
        [](const auto& m) {
            size_t count = m.fit.parameters.size();
            if constexpr (requires { m.fit.basis; }) count += m.fit.basis.numbers.size();
            return count;
        },
        f.model);
}

std::string description_of(const Fitted& f) {
    return std::visit([](const auto& m) { return description_of(m); }, f.model);
}

Contestant contestant_of(Fitted& f) {
    Contestant out = std::visit([&](const auto& m) { return contestant_of(m, f.dataset()); }, f.model);
    if (auto bounds = safe_views_of(f)) out = safe_contestant_of(std::move(bounds), std::move(out));
    return out;
}

std::shared_ptr<const SafeViews> safe_views_of(Fitted& f) {
    if (f.bounds.of != &f)
        f.bounds = {&f, std::visit([&](const auto& m) { return safe_views_of(m, f.dataset()); }, f.model)};
    return f.bounds.views;
}

Fitted baseline_of(Fitted& f) {
    return std::visit([&](const auto& m) { return baseline_of(m, f.dataset()); }, f.model);
}

const char* baseline_name(const Fitted& f) { return takes_light(f) ? "Lambertian" : "mean colour per texel"; }

SurfaceParts surface_parts(Fitted& f) {
    return std::visit([&](const auto& m) { return surface_parts(m, f.dataset()); }, f.model);
}

std::vector<MaterialErrors> truth_errors(Fitted& f) {
    return std::visit([&](const auto& m) { return truth_errors(m, f.dataset()); }, f.model);
}

bool takes_light(const Fitted& f) {
    return std::holds_alternative<FittedReflectance>(f.model) || std::holds_alternative<FittedLightBasis>(f.model);
}

void find_error_bars(Fitted& f, std::span<const View> shown) {
    std::visit([&](auto& m) { find_error_bars(m, f.dataset(), shown); }, f.model);
}

void write_error_bars(const std::filesystem::path& folder, Fitted& f) {
    std::visit([&](const auto& m) { write_error_bars(folder, m, f.dataset()); }, f.model);
}

void write_fit(const std::filesystem::path& folder, Fitted& f,
               const std::function<void(const std::filesystem::path&)>& add_files) {
    std::visit(
        [&](const auto& m) {
            if constexpr (requires { m.atlas; })
                write_fit(folder, m.fit, *m.atlas, [&](const std::filesystem::path& place) {
                    if (add_files) add_files(place);
                    add_model_text(m, place);
                });
            else
                write_fit(folder, m.fit, f.dataset().mesh, add_files);
        },
        f.model);
}

std::vector<FitArray> arrays_of(Fitted& f) {
    return std::visit([&](auto& m) { return arrays_of(m, f.dataset()); }, f.model);
}

void export_parameters(Fitted& f, ProblemFolder& out) {
    std::visit([&](const auto& m) { export_parameters(m, f.dataset(), out); }, f.model);
}

}  // namespace radiafit::fits
