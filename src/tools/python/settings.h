#pragma once
#include <pybind11/pybind11.h>

#include "fitting/fit_options.h"

namespace radiafit::tools::python {

/// Keyword arguments, such as terms=3 or deflate=True, as options of a fit. What a name and its value mean
/// is for FitRequest::set() to say.
inline FitSetting setting_of(const pybind11::kwargs& options) {
    namespace py = pybind11;
    FitSetting setting;
    for (const auto& [name, value] : options) {
        std::string text = py::str(value);
        if (py::isinstance<py::bool_>(value)) text = value.cast<bool>() ? "true" : "false";
        setting.emplace_back(py::str(name), std::move(text));
    }
    return setting;
}

}  // namespace radiafit::tools::python
