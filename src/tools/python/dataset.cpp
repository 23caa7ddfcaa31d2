// Packed datasets: photographs, masks and mesh where they lie, and the samples that fits read.
#include "dataset/dataset.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "base/error.h"
#include "fitting/resolve_options.h"
#include "fitting/solvers/solve.h"
#include "python/arrays.h"
#include "python/settings.h"

namespace radiafit::tools::python {
namespace {

/// What images.bin's channels are for NumPy.
py::dtype channel_type(Encoding encoding) {
    switch (encoding) {
        case Encoding::u8_srgb:
        case Encoding::u8_linear:
            return py::dtype("u1");
        case Encoding::u16_linear:
            return py::dtype("<u2");
        case Encoding::f16_linear:
            return py::dtype("<f2");
        case Encoding::f32_linear:
            return py::dtype("<f4");
    }
    throw std::logic_error("an encoding without a type");
}

const View& view_at(const Dataset& dataset, size_t view) {
    if (view >= dataset.views.size())
        throw py::index_error("view " + std::to_string(view) + ": the dataset has " +
                              std::to_string(dataset.views.size()));
    return dataset.views[view];
}

/// A part of images.bin, mapped into memory and read as it is looked at.
py::object mapped(const Dataset& dataset, const py::dtype& type, uint64_t offset, const py::tuple& shape) {
    return py::module_::import("numpy").attr("memmap")(dataset.folder / "images.bin", type, "r", offset, shape);
}

py::object image(const Dataset& dataset, size_t index) {
    const View& view = view_at(dataset, index);
    return mapped(dataset, channel_type(dataset.encoding), view.pixel_offset,
                  py::make_tuple(view.camera.height, view.camera.width, 3));
}

/// As booleans: unpacked, since NumPy has none of one bit.
py::object mask(const Dataset& dataset, size_t index) {
    const View& view = view_at(dataset, index);
    if (!view.mask_offset) return py::none();
    const int row = (view.camera.width + 7) / 8;
    const py::object bits =
        mapped(dataset, py::dtype("u1"), *view.mask_offset, py::make_tuple(view.camera.height, row));
    const py::object unpacked = py::module_::import("numpy").attr("unpackbits")(bits, py::arg("axis") = 1,
                                                                                py::arg("count") = view.camera.width);
    return unpacked.attr("view")(py::dtype("?"));
}

std::vector<double> numbers(const Vec3d& v) { return {v.x(), v.y(), v.z()}; }

/// The samples of the training views that a fit with these options reads.
std::shared_ptr<SampleList> samples(const Dataset& dataset, const py::kwargs& options) {
    const FitSetting setting = setting_of(options);
    const py::gil_scoped_release others_run;
    if (dataset.has_grid())
        throw UserError(dataset.folder.string() + ": a grid's images are its samples; take image()");
    FitRequest request;
    for (const auto& [name, value] : setting) request.set(name, value);
    resolve_options(given_by(setting), dataset, request);
    const std::vector<uint32_t> views = fitted_views(dataset, request);
    const LfmOptions sides = with_sides(request, dataset, views).model;
    return std::make_shared<SampleList>(list_samples(dataset, surface_atlas(dataset.mesh, sides), request, views));
}

void add_view(py::module_& module) {
    using namespace py::literals;
    py::class_<View>(module, "View", "One posed photograph.")
        .def_readonly("name", &View::name)
        .def_readonly("held_out", &View::held_out, "never fitted, only judged")
        .def_property_readonly(
            "size", [](const View& v) { return py::make_tuple(v.camera.width, v.camera.height); },
            "width and height as stored, which may be a part of the photograph")
        .def_property_readonly(
            "gain", [](const View& v) { return v.gain.channels; },
            "what linear red, green and blue are multiplied by before they are fitted")
        .def_property_readonly(
            "eye",
            [](const View& v) -> py::object {
                if (v.camera_direction) return py::none();
                return py::cast(numbers(v.camera.center()));
            },
            "where the camera was, in the mesh's frame; None where it was far away")
        .def_property_readonly(
            "light",
            [](const View& v) -> py::object {
                if (!v.light) return py::none();
                const bool distant = v.light->kind == Light::Kind::distant;
                return py::dict("kind"_a = distant ? "distant" : "near", "place"_a = numbers(v.light->place),
                                "intensity"_a = numbers(v.light->intensity));
            },
            "the lamp of this photograph, where light moves; a distant one's place is the unit "
            "direction to it");
}

void add_samples(py::module_& module) {
    py::class_<SampleList, std::shared_ptr<SampleList>>(
        module, "Samples",
        "What a fit reads of the training photographs: pixels in texels, by triangle, then image, then texel.")
        .def_property_readonly(
            "colours",
            [](const py::object& self) {
                const auto& samples = self.cast<const SampleList&>().samples;
                return view_of(samples.empty() ? nullptr : samples[0].rgb, {py::ssize_t(samples.size()), 3}, self,
                               {sizeof(Sample), 2});
            },
            "[sample, channel]; values are these times scale")
        .def_property_readonly(
            "texels",
            [](const py::object& self) {
                const auto& samples = self.cast<const SampleList&>().samples;
                return view_of(samples.empty() ? nullptr : &samples[0].local, {py::ssize_t(samples.size())}, self,
                               {sizeof(Sample)});
            },
            "[sample] texel of its triangle")
        .def_property_readonly(
            "group_images",
            [](const py::object& self) {
                const auto& groups = self.cast<const SampleList&>().groups;
                return view_of(&groups[0].image, {py::ssize_t(groups.size()) - 1}, self, {sizeof(SampleGroup)});
            },
            "[group] the place in views of the image that a triangle's samples are from")
        .def_property_readonly(
            "group_first",
            [](const py::object& self) {
                const auto& groups = self.cast<const SampleList&>().groups;
                return view_of(&groups[0].first, {py::ssize_t(groups.size())}, self, {sizeof(SampleGroup)});
            },
            "[groups + 1] where a group's samples begin")
        .def_property_readonly(
            "triangle_groups",
            [](const py::object& self) { return view_of(self.cast<const SampleList&>().tile_groups, self); },
            "[triangles + 1] where a triangle's groups begin")
        .def_property_readonly(
            "views", [](const py::object& self) { return view_of(self.cast<const SampleList&>().views, self); },
            "[image] the view of the dataset")
        .def_readonly("scale", &SampleList::scale);
}

}  // namespace

void add_dataset(py::module_& module) {
    using namespace py::literals;
    add_view(module);
    add_samples(module);
    py::class_<Dataset, std::shared_ptr<Dataset>>(module, "Dataset",
                                                  "A packed dataset, as `radiafit import` and `generate` write it.")
        .def(py::init(
                 [](const std::filesystem::path& folder) { return std::make_shared<Dataset>(open_dataset(folder)); }),
             "folder"_a)
        .def_readonly("name", &Dataset::name)
        .def_readonly("description", &Dataset::description)
        .def_readonly("source", &Dataset::source, "where it is from, and its terms")
        .def_readonly("folder", &Dataset::folder)
        .def_property_readonly(
            "encoding", [](const Dataset& d) { return to_string(d.encoding); }, "of images: u8-srgb, u16-linear, ...")
        .def_readonly("views", &Dataset::views)
        .def_property_readonly(
            "training", [](const Dataset& d) { return d.split(false); }, "indices into views")
        .def_property_readonly(
            "held_out", [](const Dataset& d) { return d.split(true); }, "likewise")
        .def_property_readonly(
            "vertices",
            [](const py::object& self) {
                const auto& positions = self.cast<const Dataset&>().mesh.positions;
                return view_of(reinterpret_cast<const float*>(positions.data()), {py::ssize_t(positions.size()), 3},
                               self);
            },
            "[vertex, 3] of the mesh")
        .def_property_readonly(
            "triangles",
            [](const py::object& self) {
                const auto& triangles = self.cast<const Dataset&>().mesh.triangles;
                return view_of(reinterpret_cast<const uint32_t*>(triangles.data()), {py::ssize_t(triangles.size()), 3},
                               self);
            },
            "[triangle, 3] vertices, counter-clockwise from outside")
        .def("image", &image, "view"_a, "[row, column, channel] as stored, read from disk where it is looked at")
        .def("mask", &mask, "view"_a, "[row, column] whether a pixel shows the object; None: there is no mask")
        .def("samples", &samples, "What a fit with these options reads of the training photographs, around a mesh.");
}

}  // namespace radiafit::tools::python
