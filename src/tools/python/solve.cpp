// Many small least-squares problems from NumPy's arrays.
#include <pybind11/stl.h>

#include <cmath>
#include <limits>
#include <optional>

#include "base/choose.h"
#include "base/error.h"
#include "batch/arrange.h"
#include "python/arrays.h"

namespace radiafit::tools::python {
namespace {

using namespace batch;

template <class T>
using Input = py::array_t<T, py::array::c_style | py::array::forcecast>;

template <class T>
ShapedArray<T> shaped(const char* name, const Input<T>& array) {
    return {name, {array.shape(), array.shape() + array.ndim()}, {array.data(), size_t(array.size())}};
}

/// An array of ours, which keeps its numbers.
template <class T>
py::array array_of(std::vector<T>&& numbers, std::vector<py::ssize_t> shape) {
    auto* kept = new std::vector<T>(std::move(numbers));
    const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
    return py::array_t<T>(std::move(shape), kept->data(), owner);
}

struct Call {
    py::object terms, targets, weights, offsets, start;
    Options options;
};

template <class real>
py::dict solved(const ModelText& text, const Call& call, Precision precision) {
    const Input<real> terms(call.terms), targets(call.targets);
    ProblemArrays<real> arrays{.terms = shaped("terms", terms), .targets = shaped("targets", targets)};
    Input<real> weights, start;
    Input<int64_t> offsets;
    if (!call.weights.is_none()) arrays.weights = shaped("weights", weights = Input<real>(call.weights));
    if (!call.offsets.is_none()) arrays.offsets = shaped("offsets", offsets = Input<int64_t>(call.offsets));
    std::vector<real> named;
    if (py::isinstance<py::dict>(call.start)) {
        for (const double x :
             of_parameters(text, "start", call.start.cast<ByName>(), std::numeric_limits<double>::quiet_NaN()))
            named.push_back(real(x));
        arrays.starts = ShapedArray<real>{"start", {named.size()}, named};
    } else {
        arrays.starts = shaped("start", start = Input<real>(call.start));
    }
    Solution<real> solution;
    Problems<real> problems;
    {
        const py::gil_scoped_release others_run;
        problems = arranged(text, arrays);
        solution = solve(CompiledModel(text, precision), problems, call.options);
    }
    const auto n = py::ssize_t(problems.count), p = py::ssize_t(text.parameters.size());
    py::dict out;
    out["parameters"] = array_of(std::move(solution.parameters), {n, p});
    out["sigma"] = array_of(std::move(solution.deviations), {n, p});
    out["covariance"] =
        call.options.covariance ? py::object(array_of(std::move(solution.covariance), {n, p, p})) : py::none();
    out["chi2"] = array_of(std::move(solution.error), {n});
    out["status"] = array_of(std::move(solution.status), {n});
    out["iterations"] = array_of(std::move(solution.steps), {n});
    out["samples"] = array_of(std::move(solution.samples), {n});
    py::list statuses;
    for (int s = 0; s < int(BatchStatus::count); ++s) statuses.append(name_of(BatchStatus(s)));
    out["status_names"] = statuses;
    out["parameter_names"] = text.parameters;
    return out;
}

py::dict solve_arrays(const std::string& model, py::object terms, py::object targets, py::object start,
                      py::object weights, py::object offsets, const ByName& lower, const ByName& upper,
                      const std::vector<std::string>& fix, const std::string& precision, const std::string& optimizer,
                      double learning_rate, std::optional<int> iterations, double tolerance, const std::string& loss,
                      double loss_scale, bool known_noise, bool covariance) {
    const ModelText text = model.find('{') == std::string::npos ? read_model_file(model) : read_model("model", model);
    Call call{std::move(terms), std::move(targets), std::move(weights), std::move(offsets), std::move(start), {}};
    call.options = {.optimizer = choose<BatchOptimizer>("optimizer", optimizer, batch_optimizers()),
                    .learning_rate = learning_rate,
                    .iterations = iterations,
                    .tolerance = tolerance,
                    .lower = of_parameters(text, "lower", lower, -INFINITY),
                    .upper = of_parameters(text, "upper", upper, INFINITY),
                    .fixed = among_parameters(text, "fix", fix),
                    .loss = choose<BatchLoss>("loss", loss, batch_losses()),
                    .loss_scale = loss_scale,
                    .known_noise = known_noise,
                    .covariance = covariance};
    const auto chosen = choose<Precision>("precision", precision, precisions());
    return chosen == Precision::double_precision ? solved<double>(text, call, chosen)
                                                 : solved<float>(text, call, chosen);
}

}  // namespace

void add_solve(py::module_& module) {
    using namespace py::literals;
    module.def("solve", solve_arrays, "model"_a, "terms"_a, "targets"_a, py::kw_only(), "start"_a,
               "weights"_a = py::none(), "offsets"_a = py::none(), "lower"_a = ByName(), "upper"_a = ByName(),
               "fix"_a = std::vector<std::string>(), "precision"_a = "double", "optimizer"_a = "lm",
               "learning_rate"_a = Options().learning_rate, "iterations"_a = py::none(), "tolerance"_a = 0.0,
               "loss"_a = "square", "loss_scale"_a = 1.0, "known_noise"_a = false, "covariance"_a = true,
               "Fits a model, a text or the name of its file, to many small sets of samples (docs/solve.md). terms: "
               "[problem, sample, term], or [sample, term] for all problems; targets: [problem, sample, value]; with "
               "offsets [sample, ...] of all problems. start: a dict by name, [parameter], [problem, parameter] or "
               "[start, problem or 1, parameter].");
}

}  // namespace radiafit::tools::python
