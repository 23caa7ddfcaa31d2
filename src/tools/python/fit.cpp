// Fits: made, opened, judged, shown; their numbers where they lie.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <optional>
#include <type_traits>

#include "base/error.h"
#include "base/read_file.h"
#include "eval/render.h"
#include "fitting/family.h"
#include "fitting/leave_fit.h"
#include "fitting/parts/parts.h"
#include "fitting/resolve_options.h"
#include "python/arrays.h"
#include "python/settings.h"

namespace radiafit::tools::python {
namespace {

/// How a fit that is not on disk yet was made.
struct Making {
    std::shared_ptr<const Dataset> dataset;
    FitRequest request;
    Record begun;
};

struct Fit {
    FinishedFit done;
    std::optional<Making> making;  ///< none: it was opened
    std::filesystem::path folder;  ///< where it lies; empty: nowhere yet
    Fitted& fitted() { return done.fit; }
    const Fitted& fitted() const { return done.fit; }
};

/// What a fit's record says of the call that made it.
Record begin(const Dataset& dataset, const FitSetting& setting) {
    std::vector<std::string> words = {"radiafit.fit", dataset.folder.string()};
    for (const auto& [name, value] : setting) words.push_back(name + "=" + value);
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    return begin_record(dataset, int(argv.size()), argv.data());
}

Fit fit(std::shared_ptr<const Dataset> dataset, const py::kwargs& options) {
    const FitSetting setting = setting_of(options);
    const py::gil_scoped_release others_run;
    FitRequest request;
    for (const auto& [name, value] : setting) request.set(name, value);
    resolve_options(given_by(setting), *dataset, request);
    reject_idle_options(request, dataset->has_grid());
    if (needs_parts(*dataset, request))
        throw UserError("memory: this fit takes more in one piece; choose more, or run radiafit fit --memory");
    const Record begun = begin(*dataset, setting);
    Fit out{family_of(request).fit(*dataset, request), {}, {}};
    require_result(out.fitted().record(), *dataset);
    out.making = {std::move(dataset), request, begun};
    return out;
}

void save(Fit& fit, const std::filesystem::path& folder, bool replace) {
    const py::gil_scoped_release others_run;
    if (!fit.making) throw UserError("this fit lies in " + fit.folder.string() + " already; copy that folder");
    if (!replace && folder_exists(folder) && !std::filesystem::is_empty(folder))
        throw UserError(folder.string() +
                        ": is there already; replace=True puts this one in its place, or choose another name");
    save_fit(folder, fit.done, fit.making->request, fit.making->begun);
    fit.folder = folder;
}

py::object parsed(const std::string& json) { return py::module_::import("json").attr("loads")(json); }

py::object judged(Fit& fit, const std::string& split, bool baseline) {
    if (split != "held_out" && split != "training")
        throw UserError("split '" + split + "': choose held_out or training");
    const Split of = split == "training" ? Split::train : Split::test;
    std::string json;
    {
        const py::gil_scoped_release others_run;
        const JudgeOptions options = {.ssim = true};
        const auto figures = [&](Fitted& fitted) {
            return judge(contestant_of(fitted), fitted.dataset(), of, options);
        };
        const JudgeResult result = figures(fit.fitted());
        if (baseline) {
            auto trivial = baseline_of(fit.fitted());
            const JudgeResult beside = figures(trivial);
            json = judge_json(result, &beside);
        } else {
            json = judge_json(result);
        }
    }
    return parsed(json);
}

/// [height, width, red green blue alpha], alpha the share of a pixel that the object covers.
py::array rendered(Fit& fit, size_t view, const std::vector<double>& light) {
    LightImage image;
    {
        const py::gil_scoped_release others_run;
        const Dataset& dataset = fit.fitted().dataset();
        if (view >= dataset.views.size())
            throw UserError("view " + std::to_string(view) + ": the dataset has " +
                            std::to_string(dataset.views.size()));
        View shown = dataset.views[view];
        if (!light.empty()) {
            if (!takes_light(fit.fitted()))
                throw UserError("light: this fit keeps the light it was photographed under");
            const Vec3d direction = light.size() == 3 ? Vec3d(light[0], light[1], light[2]) : Vec3d::Zero();
            if (!(direction.norm() > 0 && std::isfinite(direction.norm())))
                throw UserError("light: a direction has three numbers, not all 0; choose, say, [0, 0.6, 0.8]");
            shown.light = Light{Light::Kind::distant, direction.normalized(), Vec3d::Ones()};
        }
        image = render(contestant_of(fit.fitted()), dataset, shown);
    }
    py::array_t<float> out({image.height, image.width, 4});
    float* at = out.mutable_data();
    for (size_t i = 0; i < image.coverage.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) *at++ = image.rgb[3 * i + c];
        *at++ = image.coverage[i];
    }
    return out;
}

/// By name.
py::dict arrays(const py::object& self) {
    py::dict all;
    for (const FitArray& a : arrays_of(self.cast<Fit&>().fitted())) {
        const std::vector<py::ssize_t> shape(a.shape.begin(), a.shape.end()),
            strides(a.strides.begin(), a.strides.end());
        py::array array(py::dtype(std::string(a.type)), shape, strides, a.data, self);
        array.attr("flags").attr("writeable") = false;
        all[py::str(a.name)] = array;
    }
    return all;
}

std::vector<std::string> status_names() {
    std::vector<std::string> names;
    for (size_t s = 0; s < size_t(Status::count); ++s) names.push_back(to_string(Status(s)));
    return names;
}

/// A vector of the fit's record.
template <auto Member>
py::array of_problems(const py::object& self) {
    const auto& elements = self.cast<Fit&>().fitted().record().*Member;
    using Element = typename std::decay_t<decltype(elements)>::value_type;
    if constexpr (std::is_enum_v<Element>)
        return view_of(reinterpret_cast<const std::underlying_type_t<Element>*>(elements.data()),
                       {py::ssize_t(elements.size())}, self);
    else
        return view_of(elements, self);
}

}  // namespace

void add_fit(py::module_& module) {
    using namespace py::literals;
    module.def("fit", &fit, "dataset"_a,
               "Fits a model, as `radiafit fit` does with these options: "
               "fit(dataset, model=\"lafortune\", clip_above=0.98).");
    module.def(
        "open_fit",
        [](const std::filesystem::path& folder, const std::filesystem::path& dataset) {
            Fit out;
            out.done.fit = open_fit(folder, dataset);
            out.folder = folder;
            return out;
        },
        "folder"_a, "dataset"_a = "", "A fit that `radiafit fit` wrote; dataset: where that is now, if it moved.");
    module.attr("status_names") = status_names();
    py::class_<Fit>(module, "Fit", "Parameters that were fitted to a dataset.")
        .def_property_readonly("description", [](const Fit& f) { return description_of(f.fitted()); })
        .def_property_readonly(
            "options", [](const Fit& f) { return parsed(f.fitted().record().options_json); },
            "every option that it was made with")
        .def_property_readonly("arrays", &arrays, "its parameters by name, without copies")
        .def_property_readonly(
            "array_meanings",
            [](Fit& f) {
                py::dict all;
                for (const FitArray& a : arrays_of(f.fitted())) all[py::str(a.name)] = a.meaning;
                return all;
            },
            "what the indices of arrays are, by name")
        .def_property_readonly("status", &of_problems<&FitRecord::status>,
                               "[problem] how each ended, an index into status_names")
        .def_property_readonly("iterations", &of_problems<&FitRecord::iterations>, "[problem]")
        .def_property_readonly("samples", &of_problems<&FitRecord::samples>, "[problem] that count")
        .def_property_readonly("error", &of_problems<&FitRecord::error>, "[problem] half the sum of squared residuals")
        .def("save", &save, "folder"_a, "replace"_a = false,
             "Writes it as `radiafit fit` does; replace: over an earlier fit.")
        .def("judge", &judged, "split"_a = "held_out", "baseline"_a = true,
             "The figures of `radiafit judge`: psnr, ape, ssim, per_image, ...; split: held_out or training.")
        .def("render", &rendered, "view"_a, "light"_a = std::vector<double>(),
             "[row, column, red green blue alpha] of a view in linear light; light: the direction to another lamp.");
}

}  // namespace radiafit::tools::python
