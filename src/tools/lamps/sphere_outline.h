#pragma once
#include <optional>
#include <vector>

#include "lamps/luminance_image.h"

/// Where glossy spheres are in images: their outlines, which far cameras see as circles.
namespace radiafit::tools {

struct Circle {
    Vec2d centre = Vec2d::Zero();  ///< pixels, as of LuminanceImage
    double radius = 0;
    double deviation = 0;  ///< standard deviation of centre and radius, pixels
};

/// Finds glossy spheres in images of one scene under different lamps. On a sphere every lamp has a highlight of its
/// own, within 7/10 of the radius if it is above the plane; and its outline is an edge in many images, whatever pattern
/// is beside it.
class SphereFinder {
public:
    /// All of one size.
    void add(const LuminanceImage& image);

    /// The most likely ones first, at most `count`, apart from each other; their highlights lie within a sixth of the
    /// shorter side. Fewer where fewer have highlights of a quarter of the images, and an outline around them.
    std::vector<Circle> find(size_t count) const;
    /// The outline near `about`, within a sixth of its radius, to a fraction of a pixel: the strongest edges along 360
    /// rays from its centre, and the circle of least squares through those that lie near it. None: fewer than half do.
    std::optional<Circle> refined(const Circle& about) const;

private:
    std::vector<Vec2d> spots() const;  ///< places that one image, or a few, shows bright and the others dark
    /// Edges, and halved again and again, until a circle of such a radius is small.
    std::vector<LuminanceImage> edge_levels(double radius) const;
    std::optional<Circle> outline_around(const std::vector<Vec2d>& highlights) const;
    /// `circle`: in the smallest of the levels.
    static std::optional<Circle> sharpened(const std::vector<LuminanceImage>& levels, Circle circle);

    size_t images_ = 0;
    LuminanceImage sum_, brightest_;
    LuminanceImage edges_;  ///< sum over the images of the gradient's size, over the image's mean
};

}  // namespace radiafit::tools
