#pragma once
#include <array>
#include <vector>

#include "dataset/image_stream.h"
#include "eval/metrics.h"
#include "geometry/raster.h"

/// How far what a picture shows is from what was fitted, point by point of the surface.
namespace radiafit {

/// Of a surface point, the training image next to a view is the one with the smallest angle, at that point, between the
/// directions to their cameras; where each image has a lamp, the larger of this and the angle between the directions to
/// their lamps. Only images that see the point count: one of their pixels shows its triangle, or the grid's texel,
/// inside the mask. (Whether their lamp lights it isn't asked.)
class NearestTraining {
public:
    /// Draws every training view once, and reads their masks from `stream`, which is the dataset's. The dataset must
    /// outlive it.
    NearestTraining(const Dataset& dataset, const ImageStream& stream);

    /// Radians from `view` to its next training image at what `pixel` shows; infinite where no training image sees
    /// that. Thread-safe.
    double angle(const View& view, const RasterPixel& pixel) const;

private:
    const Dataset* dataset_;
    std::vector<std::vector<uint32_t>> seen_by_;  ///< training views by triangle, or by texel
};

/// Errors by that angle.
struct ErrorsByAngle {
    /// Upper bounds, degrees: the first bin is from 0 to 3, the last of all angles beyond 30.
    static constexpr std::array<double, 6> bounds = {3, 6, 10, 15, 20, 30};
    std::array<ErrorSums, bounds.size() + 1> bins;
    ErrorSums unseen;  ///< where no training image sees the surface

    ErrorSums& at(double angle);  ///< radians
    void add(const ErrorsByAngle& other);
    bool any() const;  ///< whether there is an error in it
};

}  // namespace radiafit
