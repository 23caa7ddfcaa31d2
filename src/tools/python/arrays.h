#pragma once
#include <pybind11/numpy.h>

#include <cstdint>
#include <vector>

/// Memory of ours as NumPy arrays, without copies.
namespace radiafit::tools::python {

namespace py = pybind11;

/// Read-only; keeps `owner`, a Python object whose memory this is, alive. strides: bytes; none: without gaps.
template <class T>
py::array view_of(const T* data, std::vector<py::ssize_t> shape, const py::object& owner,
                  std::vector<py::ssize_t> strides = {}) {
    py::array_t<T> array = strides.empty() ? py::array_t<T>(std::move(shape), data, owner)
                                           : py::array_t<T>(std::move(shape), std::move(strides), data, owner);
    array.attr("flags").attr("writeable") = false;
    return array;
}

/// The same of a vector's elements.
template <class T>
py::array view_of(const std::vector<T>& elements, const py::object& owner) {
    return view_of(elements.data(), {py::ssize_t(elements.size())}, owner);
}

void add_dataset(py::module_& module);
void add_fit(py::module_& module);
void add_solve(py::module_& module);

}  // namespace radiafit::tools::python
