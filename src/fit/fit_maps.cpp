#include "fit/fit_maps.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "base/error.h"

namespace radiafit {
namespace {

constexpr size_t quantities = 4;  // status, iterations, samples, error

ExrImage blank(int width, int height, const std::vector<std::string>& channels) {
    ExrImage image{width, height, channels, {}, {}};
    image.values.assign(size_t(width) * size_t(height) * channels.size(), 0.0f);
    return image;
}

void require_size(const std::filesystem::path& path, const ExrImage& image, int width, int height) {
    if (image.width != width || image.height != height)
        throw UserError(fmt::format("{}: {} x {} pixels where {} x {} belong; restore the file or fit again",
                                    path.string(), image.width, image.height, width, height));
}

// Calls body(pixel's first value, parameter's first channel) for every texel that the images of a term hold.
template <class Body>
void for_each_surface_texel(const TriangleAtlas& atlas, const LfmLayout& layout, int term, int corner, int width,
                            Body body) {
    for (uint32_t t = 0; t < atlas.tile_count(); ++t) {
        const size_t map = layout.map_offset(t, uint32_t(corner));
        if (map == LfmLayout::no_map) continue;
        for (uint32_t s = 0; s < atlas.texels_per_tile(); ++s) {
            const auto [x, y] = atlas.place(t * atlas.texels_per_tile() + s);
            body((size_t(y) * size_t(width) + size_t(x)) * 3, map + s * layout.stride() + 4 * size_t(term));
        }
    }
}

template <class Body>
void for_each_view_texel(const LfmLayout& layout, int term, int width, Body body) {
    const size_t side = size_t(layout.view_side()), columns = size_t(table_columns(layout.problem_count()));
    for (size_t v = 0; v < layout.problem_count(); ++v)
        for (size_t j = 0; j < side * side; ++j) {
            const size_t x = v % columns * side + j % side, y = v / columns * side + j / side;
            body((y * size_t(width) + x) * 3, layout.view_offset(v) + j * layout.stride() + 4 * size_t(term));
        }
}

uint32_t whole_number(const std::filesystem::path& path, float value, float limit, const char* what, size_t vertex) {
    if (!(value >= 0 && value < limit && value == std::floor(value)))
        throw UserError(fmt::format("{}: vertex {} has {} = {}, which cannot be; restore the file or fit again",
                                    path.string(), vertex, what, value));
    return uint32_t(value);
}

}  // namespace

const std::vector<std::string>& map_channels() {
    static const std::vector<std::string> names{"R", "G", "B"};
    return names;
}

const std::vector<std::string>& problem_channels() {
    static const std::vector<std::string> names{"status.R",     "status.G",     "status.B",  "iterations.R",
                                                "iterations.G", "iterations.B", "samples.R", "samples.G",
                                                "samples.B",    "error.R",      "error.G",   "error.B"};
    return names;
}

int table_columns(size_t vertices) { return std::max(1, int(std::ceil(std::sqrt(double(vertices))))); }

int table_rows(size_t vertices) {
    const size_t columns = size_t(table_columns(vertices));
    return std::max(1, int((vertices + columns - 1) / columns));
}

ExrImage surface_image(const TriangleAtlas& atlas, const LfmLayout& layout, const LightFieldFit& fit, int term,
                       int corner) {
    ExrImage image = blank(atlas.width(), atlas.height(), map_channels());
    for_each_surface_texel(atlas, layout, term, corner, image.width, [&](size_t pixel, size_t parameter) {
        for (size_t c = 0; c < 3; ++c) image.values[pixel + c] = fit.parameters[parameter + c];
    });
    return image;
}

void take_surface_image(const std::filesystem::path& path, const ExrImage& image, const TriangleAtlas& atlas,
                        const LfmLayout& layout, int term, int corner, LightFieldFit& fit) {
    require_size(path, image, atlas.width(), atlas.height());
    for_each_surface_texel(atlas, layout, term, corner, image.width, [&](size_t pixel, size_t parameter) {
        for (size_t c = 0; c < 3; ++c) fit.parameters[parameter + c] = image.values[pixel + c];
    });
}

ExrImage view_image(const LfmLayout& layout, const LightFieldFit& fit, int term) {
    const size_t vertices = layout.problem_count();
    const int side = layout.view_side();
    ExrImage image = blank(table_columns(vertices) * side, table_rows(vertices) * side, map_channels());
    for_each_view_texel(layout, term, image.width, [&](size_t pixel, size_t parameter) {
        for (size_t c = 0; c < 3; ++c) image.values[pixel + c] = fit.parameters[parameter + c];
    });
    return image;
}

void take_view_image(const std::filesystem::path& path, const ExrImage& image, const LfmLayout& layout, int term,
                     LightFieldFit& fit) {
    const size_t vertices = layout.problem_count();
    const int side = layout.view_side();
    require_size(path, image, table_columns(vertices) * side, table_rows(vertices) * side);
    for_each_view_texel(layout, term, image.width, [&](size_t pixel, size_t parameter) {
        for (size_t c = 0; c < 3; ++c) fit.parameters[parameter + c] = image.values[pixel + c];
    });
}

ExrImage problem_image(const LightFieldFit& fit) {
    const size_t vertices = fit.problem_count() / 3;
    ExrImage image = blank(table_columns(vertices), table_rows(vertices), problem_channels());
    for (size_t q = 0; q < 3 * vertices; ++q) {
        float* pixel = image.values.data() + q / 3 * 3 * quantities;
        const float values[quantities] = {float(fit.status[q]), float(fit.iterations[q]), float(fit.samples[q]),
                                          fit.error[q]};
        for (size_t k = 0; k < quantities; ++k) pixel[3 * k + q % 3] = values[k];
    }
    return image;
}

void take_problem_image(const std::filesystem::path& path, const ExrImage& image, size_t vertices, LightFieldFit& fit) {
    require_size(path, image, table_columns(vertices), table_rows(vertices));
    const float whole = 16777217.0f;  // counts up to 2^24 are exact in float32
    fit.status.resize(3 * vertices);
    fit.iterations.resize(3 * vertices);
    fit.samples.resize(3 * vertices);
    fit.error.resize(3 * vertices);
    for (size_t q = 0; q < 3 * vertices; ++q) {
        const float* pixel = image.values.data() + q / 3 * 3 * quantities + q % 3;
        fit.status[q] = Status(whole_number(path, pixel[0], float(Status::count), "status", q / 3));
        fit.iterations[q] = whole_number(path, pixel[3], whole, "iterations", q / 3);
        fit.samples[q] = whole_number(path, pixel[6], whole, "samples", q / 3);
        fit.error[q] = pixel[9];
    }
}

}  // namespace radiafit
