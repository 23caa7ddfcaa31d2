#include "fit/fit_maps.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "base/error.h"
#include "base/parallel.h"

namespace radiafit {
namespace {

constexpr size_t quantities = 4;  // status, iterations, samples, error

ExrImage blank(int width, int height, const std::vector<std::string>& channels) {
    ExrImage image{width, height, channels, {}, {}};
    image.values.assign(size_t(width) * size_t(height) * channels.size(), 0.0f);
    return image;
}

// Calls body(pixel's first value, parameter's first channel) for every texel that the images of a term hold.
template <class Body>
void for_each_surface_texel(const TriangleAtlas& atlas, const LfmLayout& layout, int term, int corner, int width,
                            Body body) {
    for (uint32_t t = 0; t < atlas.tile_count(); ++t) {
        const size_t map = layout.map_offset(t, uint32_t(corner));
        if (map == LfmLayout::no_map) continue;
        for (uint32_t s = 0; s < atlas.tile(t).texels(); ++s) {
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

constexpr float count_limit = 16777217.0f;  // counts up to 2^24 are exact in float32

/// `owner`: "vertex 7", what the value belongs to.
uint32_t whole_number(const std::filesystem::path& path, float value, float limit, const char* what, const char* owner,
                      size_t index, float least = 0) {
    if (!(value >= least && value < limit && value == std::floor(value)))
        throw UserError(fmt::format("{}: {} {} has {} = {}, which cannot be; restore the file or fit again",
                                    path.string(), owner, index, what, value));
    return uint32_t(value);
}

void resize_problems(FitRecord& fit, size_t problems) {
    fit.status.resize(problems);
    fit.iterations.resize(problems);
    fit.samples.resize(problems);
    fit.error.resize(problems);
}

// Calls body(pixel, texel) for every texel of an atlas that has a place, on all cores. (Of tiles of several sides,
// numbers beyond a small tile's texels have none.)
template <class Body>
void for_each_texel(const Atlas& atlas, const Body& body) {
    constexpr size_t grain = 1 << 14;
    const auto* tiles = dynamic_cast<const TriangleAtlas*>(&atlas);
    parallel_for(atlas.texel_count(), grain, [&](size_t texel, int) {
        const size_t each = atlas.texels_per_tile();
        if (tiles && texel % each >= TriangleTile::texels_of(tiles->side(uint32_t(texel / each)))) return;
        const auto [x, y] = atlas.place(uint32_t(texel));
        body(size_t(y) * size_t(atlas.width()) + size_t(x), texel);
    });
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

ExrImage surface_image(const TriangleAtlas& atlas, const LfmLayout& layout, std::span<const float> numbers, int term,
                       int corner) {
    ExrImage image = blank(atlas.width(), atlas.height(), map_channels());
    for_each_surface_texel(atlas, layout, term, corner, image.width, [&](size_t pixel, size_t parameter) {
        for (size_t c = 0; c < 3; ++c) image.values[pixel + c] = numbers[parameter + c];
    });
    return image;
}

void take_surface_image(const std::filesystem::path& path, const TriangleAtlas& atlas, const LfmLayout& layout,
                        int term, int corner, LightFieldFit& fit) {
    take_surface_image(read_exr(path, map_channels(), {{atlas.width(), atlas.height()}}), atlas, layout, term, corner,
                       fit);
}

void take_surface_image(const ExrImage& image, const TriangleAtlas& atlas, const LfmLayout& layout, int term,
                        int corner, LightFieldFit& fit) {
    for_each_surface_texel(atlas, layout, term, corner, image.width, [&](size_t pixel, size_t parameter) {
        for (size_t c = 0; c < 3; ++c) fit.parameters[parameter + c] = image.values[pixel + c];
    });
}

ExrImage view_image(const LfmLayout& layout, std::span<const float> numbers, int term) {
    const size_t vertices = layout.problem_count();
    const int side = layout.view_side();
    ExrImage image = blank(table_columns(vertices) * side, table_rows(vertices) * side, map_channels());
    for_each_view_texel(layout, term, image.width, [&](size_t pixel, size_t parameter) {
        for (size_t c = 0; c < 3; ++c) image.values[pixel + c] = numbers[parameter + c];
    });
    return image;
}

uint64_t largest_image_bytes(const TriangleAtlas& atlas, const LfmLayout& layout) {
    const uint64_t vertices = layout.problem_count(), texels = uint64_t(layout.view_texels());
    const uint64_t surface = uint64_t(atlas.width()) * uint64_t(atlas.height());
    const uint64_t view = uint64_t(table_columns(vertices)) * uint64_t(table_rows(vertices)) * texels;
    return std::max(surface, view) * 3 * sizeof(float);
}

bool written_side_by_side(const TriangleAtlas& atlas, const LfmLayout& layout) {
    constexpr uint64_t large = 100'000'000;
    return largest_image_bytes(atlas, layout) < large;
}

void take_view_image(const std::filesystem::path& path, const LfmLayout& layout, int term, LightFieldFit& fit) {
    const size_t vertices = layout.problem_count();
    const int side = layout.view_side();
    take_view_image(read_exr(path, map_channels(), {{table_columns(vertices) * side, table_rows(vertices) * side}}),
                    layout, term, fit);
}

void take_view_image(const ExrImage& image, const LfmLayout& layout, int term, LightFieldFit& fit) {
    for_each_view_texel(layout, term, image.width, [&](size_t pixel, size_t parameter) {
        for (size_t c = 0; c < 3; ++c) fit.parameters[parameter + c] = image.values[pixel + c];
    });
}

ExrImage side_image(const std::vector<uint8_t>& sides) {
    ExrImage image = blank(table_columns(sides.size()), table_rows(sides.size()), {"side"});
    std::copy(sides.begin(), sides.end(), image.values.begin());
    return image;
}

TileSides read_sides(const std::filesystem::path& path, size_t triangles, int most) {
    const ExrImage image = read_exr(path, {"side"}, {{table_columns(triangles), table_rows(triangles)}});
    std::vector<uint8_t> sides;
    for (size_t t = 0; t < triangles; ++t) {
        sides.push_back(
            uint8_t(whole_number(path, image.values[t], float(most) + 1, "side", "triangle", t, float(least_side))));
    }
    return std::make_shared<const std::vector<uint8_t>>(std::move(sides));
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

ExrImage error_bar_image(const ErrorBarMaps& bars) {
    const size_t vertices = bars.noise.size() / 3;
    ExrImage image = blank(table_columns(vertices), table_rows(vertices),
                           {"noise.R", "noise.G", "noise.B", "deficient.R", "deficient.G", "deficient.B"});
    for (size_t q = 0; q < 3 * vertices; ++q) {
        float* pixel = image.values.data() + q / 3 * 6 + q % 3;
        pixel[0] = bars.noise[q];
        pixel[3] = float(bars.deficient[q]);
    }
    return image;
}

void take_problem_image(const std::filesystem::path& path, size_t vertices, LightFieldFit& fit) {
    const ExrImage image = read_exr(path, problem_channels(), {{table_columns(vertices), table_rows(vertices)}});
    resize_problems(fit, 3 * vertices);
    for (size_t q = 0; q < 3 * vertices; ++q) {
        const float* pixel = image.values.data() + q / 3 * 3 * quantities + q % 3;
        fit.status[q] = Status(whole_number(path, pixel[0], float(Status::count), "status", "vertex", q / 3));
        fit.iterations[q] = whole_number(path, pixel[3], count_limit, "iterations", "vertex", q / 3);
        fit.samples[q] = whole_number(path, pixel[6], count_limit, "samples", "vertex", q / 3);
        fit.error[q] = pixel[9];
    }
}

const std::vector<std::string>& texel_problem_channels() {
    static const std::vector<std::string> names{"status", "iterations", "samples", "error"};
    return names;
}

std::vector<TexelMap> maps_of(const TexelModel& model) {
    std::vector<TexelMap> maps;
    for (size_t k = 0; k < size_t(model.basis); ++k)
        maps.push_back({model.coefficient_names[k] + ".exr", map_channels(), 3 * k});
    if (model.shape > 0) maps.push_back({"shape.exr", model.shape_names, 3 * size_t(model.basis)});
    return maps;
}

ExrImage parameter_image(const Atlas& atlas, std::span<const float> parameters, const TexelMap& map) {
    ExrImage image = blank(atlas.width(), atlas.height(), map.channels);
    const size_t channels = map.channels.size(), each = parameters.size() / atlas.texel_count();
    for_each_texel(atlas, [&](size_t pixel, size_t texel) {
        std::copy_n(&parameters[texel * each + map.first], channels, &image.values[pixel * channels]);
    });
    return image;
}

void take_parameter_image(const std::filesystem::path& folder, const Atlas& atlas, const TexelMap& map,
                          std::span<float> parameters) {
    take_parameter_image(read_exr(folder / map.file, map.channels, {{atlas.width(), atlas.height()}}), atlas, map,
                         parameters);
}

void take_parameter_image(const ExrImage& image, const Atlas& atlas, const TexelMap& map, std::span<float> parameters) {
    const size_t channels = map.channels.size(), each = parameters.size() / atlas.texel_count();
    for_each_texel(atlas, [&](size_t pixel, size_t texel) {
        std::copy_n(&image.values[pixel * channels], channels, &parameters[texel * each + map.first]);
    });
}

ExrImage problem_image(const Atlas& atlas, const FitRecord& fit) {
    ExrImage image = blank(atlas.width(), atlas.height(), texel_problem_channels());
    for_each_texel(atlas, [&](size_t pixel, size_t t) {
        const float values[quantities] = {float(fit.status[t]), float(fit.iterations[t]), float(fit.samples[t]),
                                          fit.error[t]};
        std::copy_n(values, quantities, &image.values[pixel * quantities]);
    });
    return image;
}

void take_problem_image(const std::filesystem::path& path, const Atlas& atlas, FitRecord& fit) {
    const ExrImage image = read_exr(path, texel_problem_channels(), {{atlas.width(), atlas.height()}});
    resize_problems(fit, atlas.texel_count());
    for_each_texel(atlas, [&](size_t pixel, size_t t) {
        const float* values = &image.values[pixel * quantities];
        fit.status[t] = Status(whole_number(path, values[0], float(Status::count), "status", "texel", t));
        fit.iterations[t] = whole_number(path, values[1], count_limit, "iterations", "texel", t);
        fit.samples[t] = whole_number(path, values[2], count_limit, "samples", "texel", t);
        fit.error[t] = values[3];
    });
}

}  // namespace radiafit
