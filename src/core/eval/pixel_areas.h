#pragma once
#include <cstdint>
#include <vector>

#include "eval/contestant.h"

namespace radiafit {

/// A camera's pixel holds the mean of the light that meets its area, not what its centre sees: a contestant is asked
/// at n x n points of each pixel, evenly spaced, and the mean is taken in linear light over the points that see the
/// surface. Over a grid, whose pixels are its texels, at one.
inline constexpr int area_points = 3;
inline constexpr int as_photographed = 0;  ///< area_points; or 1, where synthetic images were shaded at texels' centres

/// Throws UserError unless n is odd (so that one of the points is the centre) and at most 9.
void check_pixel_points(int n);

class PixelAreas {
public:
    /// points: n, or as_photographed. 1: as the centre sees it, which is what a graphics chip draws. The dataset must
    /// outlive it.
    explicit PixelAreas(const Dataset& dataset, int points = as_photographed);

    /// `view` may be any, not only the dataset's. worker: as Contestant's. Outside of a parallel loop several parts of
    /// the picture are shaded at once.
    void shade(const Contestant& contestant, const View& view, int worker);

    /// [height][width] what pixels' centres see, in the view shaded last.
    const std::vector<RasterPixel>& centres() const { return centres_; }
    const std::vector<float>& rgb() const {
        return rgb_;
    }                                       ///< [...][3] in the contestant's space; 0 where none is seen
    int points() const { return points_; }  ///< n
    float coverage(size_t pixel) const;     ///< share of its points that see the surface

private:
    void shade_areas(const Contestant& contestant, const View& view);
    struct Tile;
    void shade_tile(const Contestant& contestant, const View& view, const Tile& tile, int worker);

    const Dataset* dataset_;
    int points_;
    /// A part of the picture, its points as pixels.
    struct Shot {
        Rasterizer rasterizer;
        std::vector<float> rgb;
    };
    std::vector<Shot> shots_;  ///< of each worker
    Rasterizer rasterizer_;
    std::vector<RasterPixel> centres_;
    std::vector<float> rgb_;
    std::vector<uint8_t> seen_;  ///< points of a pixel
};

/// What the pixels of a view see: of the mesh, by `rasterizer`; or of the grid, where `triangle` is the texel.
std::vector<RasterPixel> seen_pixels(const Dataset& dataset, const View& view, Rasterizer& rasterizer);

}  // namespace radiafit
