#pragma once
#include <memory>
#include <vector>

#include "eval/contestant.h"
#include "eval/reflectance_renderer.h"

namespace radiafit {

/// Shows a texel-local model where its images determine it, and a model that can't go astray elsewhere:
///  - a texel is never darker than 0, nor brighter, per channel and irradiance, than `most` times the brightest
///    that its fit is at a training image;
///  - where lamp or camera leave the cone of the training images' directions by more than `trusted` radians, the fit
///    fades, within `fade` radians more, to the Lambertian colour nearest to it over the training images;
///  - texels without samples have the mean Lambertian colour of the others.
class SafeRelighting {
public:
    static constexpr float most = 2;
    static constexpr double trusted = 0.17453292519943295, fade = 0.3490658503988659;  ///< 10 and 20 degrees

    /// What is known of a texel from its fit at the training images.
    struct Bounds {
        Vec3f albedo = Vec3f::Zero();     ///< Lambertian
        Vec3f brightest = Vec3f::Zero();  ///< per unit of irradiance
    };

    /// `training`: views that the fit used. All must outlive it.
    SafeRelighting(const Dataset& dataset, const std::vector<uint32_t>& training, const Atlas& atlas,
                   const ReflectanceFit& fit);
    /// bounds: [texels], used instead of finding them.
    SafeRelighting(const Dataset& dataset, const std::vector<uint32_t>& training, const Atlas& atlas,
                   const ReflectanceFit& fit, std::vector<Bounds> bounds);

    /// As ReflectanceRenderer. Thread-safe.
    void shade(const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb) const;
    /// How much of a fit is shown to a view that lies so far outside (radians).
    static double share_at(double outside);
    /// Of one texel, with such a share of the fit.
    Vec3f colour_of(uint32_t texel, const View& view, float share) const;
    /// How much of the fit such a view shows: 1 amid the training images and near them, 0 far beyond.
    double share_of_fit(const View& view) const;
    const std::vector<Bounds>& bounds() const { return bounds_; }  ///< [texels]

private:
    void find_bounds();
    Bounds bounds_of(uint32_t texel) const;

    ReflectanceRenderer renderer_;
    const Dataset* dataset_;
    const Atlas* atlas_;
    const ReflectanceFit* fit_;
    Vec3d centre_;
    std::vector<const View*> training_;
    std::vector<Vec3d> cameras_, lamps_;  ///< directions of the training views
    std::vector<Bounds> bounds_;          ///< [texels]
};

Contestant contestant_of(std::shared_ptr<const SafeRelighting> shown);
/// All must outlive the contestant.
Contestant safe_contestant_of(const ReflectanceFit& fit, const Atlas& atlas, const Dataset& dataset,
                              const std::vector<uint32_t>& training);

}  // namespace radiafit
