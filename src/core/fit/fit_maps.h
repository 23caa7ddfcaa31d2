#pragma once
#include <filesystem>

#include "fit/fit_folder.h"
#include "fit/texel_fit.h"
#include "geometry/atlas.h"
#include "image/exr.h"
#include "model/lfm.h"

/// Where the numbers of a fit are in its images (docs/formats.md).
namespace radiafit {

/// Vertices are arranged row by row in a table of this many columns: one cell of m x m texels each in the view maps,
/// one pixel each in problems.exr.
int table_columns(size_t vertices);
int table_rows(size_t vertices);

/// Surface maps of one term and corner, of numbers in the layout's order: R, G, B in the atlas's 2-D layout; 0 where no
/// texel is, or no map.
ExrImage surface_image(const TriangleAtlas& atlas, const LfmLayout& layout, std::span<const float> numbers, int term,
                       int corner);
/// View maps of one term as R, G, B: texel (x, y) of vertex v at (v % columns * m + x, v / columns * m + y).
ExrImage view_image(const LfmLayout& layout, std::span<const float> numbers, int term);
/// Bytes of the largest map's image.
uint64_t largest_image_bytes(const TriangleAtlas& atlas, const LfmLayout& layout);
/// Whether write_fit() has several images in memory at a time, one per thread.
bool written_side_by_side(const TriangleAtlas& atlas, const LfmLayout& layout);
/// Sides of surface maps: a pixel per triangle, row by row in table_columns(triangles).
ExrImage side_image(const std::vector<uint8_t>& sides);
/// status, iterations, samples and error, each .R, .G, .B: the vertex's three problems.
ExrImage problem_image(const LightFieldFit& fit);
/// noise and deficient, each .R, .G, .B: the vertex's three problems.
ExrImage error_bar_image(const ErrorBarMaps& bars);

/// One map of a model in texels; parameters [texels][numbers].
ExrImage parameter_image(const Atlas& atlas, std::span<const float> parameters, const TexelMap& map);
/// status, iterations, samples and error, a pixel per texel.
ExrImage problem_image(const Atlas& atlas, const FitRecord& fit);
/// A texel-local model's: each coefficient as R, G, B ("rho_d.exr"), and "shape.exr", its parameters by their names.
std::vector<TexelMap> maps_of(const TexelModel& model);

// The way back: reads the image at `path`. Throws UserError on a size or value that cannot be.
void take_surface_image(const std::filesystem::path& path, const TriangleAtlas& atlas, const LfmLayout& layout,
                        int term, int corner, LightFieldFit& fit);
TileSides read_sides(const std::filesystem::path& path, size_t triangles, int most);
void take_view_image(const std::filesystem::path& path, const LfmLayout& layout, int term, LightFieldFit& fit);
void take_problem_image(const std::filesystem::path& path, size_t vertices, LightFieldFit& fit);

void take_parameter_image(const std::filesystem::path& folder, const Atlas& atlas, const TexelMap& map,
                          std::span<float> parameters);
void take_problem_image(const std::filesystem::path& path, const Atlas& atlas, FitRecord& fit);

// The same from images in memory, which have the right sizes and channels.
void take_surface_image(const ExrImage& image, const TriangleAtlas& atlas, const LfmLayout& layout, int term,
                        int corner, LightFieldFit& fit);
void take_view_image(const ExrImage& image, const LfmLayout& layout, int term, LightFieldFit& fit);
void take_parameter_image(const ExrImage& image, const Atlas& atlas, const TexelMap& map, std::span<float> parameters);

const std::vector<std::string>& map_channels();      ///< R, G, B
const std::vector<std::string>& problem_channels();  ///< in the order problem_image() stores them
const std::vector<std::string>& texel_problem_channels();

}  // namespace radiafit
