#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/linear.h"

/// How the synthetic objects look: every constant of their light, gloss and paint. Colours are linear RGB.
namespace radiafit {

/// A distant lamp with a disc that softens its shadows.
struct Lamp {
    Vec3f direction;  ///< unit, towards the lamp
    Vec3f radiance;   ///< reflected radiance of a white diffuse surface that faces it
};
inline constexpr int lamp_count = 4;
inline constexpr float lamp_radius = 0.05f;  ///< radians
const std::array<Lamp, lamp_count>& lamps();

/// Light from everywhere else: the sky's radiance in a direction.
Vec3f sky(const Vec3f& direction);

/// A gloss: a microfacet lobe (GGX) over a diffuse ground.
struct Gloss {
    float roughness;    ///< GGX alpha; its half width at half height is about 1.3 alpha radians of viewing direction
    float reflectance;  ///< at normal incidence
    float metal;        ///< 1: the lobe takes the paint's colour and the ground is black
};

/// A region of the object: what shines alike and is painted from one palette.
struct Region {
    Gloss gloss;
    std::vector<Vec3f> palette;
    /// Region of a point: the site with the least distance / reach.
    Vec3f site;
    float reach;
};

/// Regions of "star" or "bust".
std::vector<Region> regions(const std::string& shape, uint64_t seed);

inline constexpr float cell_edges = 4.0f;     ///< width of a painted cell, in mesh edges
inline constexpr float pattern_edges = 1.6f;  ///< period of the stripes and checks inside, in mesh edges

inline constexpr double saturated_share = 0.015;  ///< of foreground pixels, by the choice of exposure
inline constexpr int supersamples = 3;            ///< per pixel and axis; odd, so that one is the centre

}  // namespace radiafit
