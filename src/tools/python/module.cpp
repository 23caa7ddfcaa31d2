// The Python module: datasets, fits, and what they are worth, for notebooks and scripts (docs/python.md).
#include "base/error.h"
#include "base/parallel.h"
#include "base/record.h"
#include "python/arrays.h"

namespace py = pybind11;

PYBIND11_MODULE(radiafit, module) {
    module.doc() = "Image-based models fitted to posed photographs. Options are those of `radiafit fit`, with _ for -.";
    module.attr("__version__") = radiafit::project_version();
    // What a user can correct: one line that names the file or the option, and the cure.
    py::register_exception<radiafit::UserError>(module, "UserError", PyExc_ValueError);
    module.def(
        "set_threads", [](int threads) { radiafit::set_thread_count(threads); }, py::arg("threads"),
        "Threads to use; 0 is all cores.");
    radiafit::tools::python::add_dataset(module);
    radiafit::tools::python::add_fit(module);
    radiafit::tools::python::add_solve(module);
}
