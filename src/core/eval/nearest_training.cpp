#include "eval/nearest_training.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "eval/seen_by.h"

namespace radiafit {
namespace {

Vec3d point_of(const Dataset& dataset, const RasterPixel& pixel) {
    if (dataset.has_grid())
        return dataset.grid.position(int(pixel.triangle % uint32_t(dataset.grid.width)),
                                     int(pixel.triangle / uint32_t(dataset.grid.width)));
    const auto& corners = dataset.mesh.triangles[pixel.triangle];
    const auto corner = [&](size_t i) { return dataset.mesh.positions[corners[i]].cast<double>(); };
    return (1 - double(pixel.b1) - double(pixel.b2)) * corner(0) + double(pixel.b1) * corner(1) +
           double(pixel.b2) * corner(2);
}

}  // namespace

NearestTraining::NearestTraining(const Dataset& dataset, const ImageStream& stream)
    : dataset_(&dataset), seen_by_(views_that_see(dataset, stream, dataset.split(false))) {}

double NearestTraining::angle(const View& view, const RasterPixel& pixel) const {
    const Vec3d point = point_of(*dataset_, pixel);
    const Vec3d to_camera = view.direction_to_camera(point);
    const Vec3d to_lamp = view.light ? view.light->direction_from(point) : Vec3d::Zero();
    double least = std::numeric_limits<double>::infinity();  // squared distance of unit vectors
    for (const uint32_t v : seen_by_[pixel.triangle]) {
        const View& training = dataset_->views[v];
        double apart = (training.direction_to_camera(point) - to_camera).squaredNorm();
        if (view.light) apart = std::max(apart, (training.light->direction_from(point) - to_lamp).squaredNorm());
        least = std::min(least, apart);
    }
    return std::isinf(least) ? least : 2 * std::asin(std::min(1.0, std::sqrt(least) / 2));
}

ErrorSums& ErrorsByAngle::at(double angle) {
    if (std::isinf(angle)) return unseen;
    const double degrees = angle * 180 / std::numbers::pi;
    return bins[size_t(std::ranges::lower_bound(bounds, degrees) - bounds.begin())];
}

void ErrorsByAngle::add(const ErrorsByAngle& other) {
    for (size_t i = 0; i < bins.size(); ++i) bins[i].add(other.bins[i]);
    unseen.add(other.unseen);
}

bool ErrorsByAngle::any() const {
    return unseen.values > 0 || std::ranges::any_of(bins, [](const ErrorSums& sums) { return sums.values > 0; });
}

}  // namespace radiafit
