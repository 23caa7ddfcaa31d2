#pragma once
#include <vector>

#include "base/rings.h"
#include "eval/contestant.h"
#include "samples/surface_photograph.h"

namespace radiafit::fits {

struct LumigraphOptions {
    int neighbours = 5;       ///< k: photographs that are blended
    double resolution = 0.3;  ///< radians that a photograph counts as farther away for every halving of its resolution
    double border = 8;        ///< pixels from a photograph's border over which it fades
};

/// The unstructured lumigraph (Buehler, Bosse, McMillan, Gortler and Cohen 2001): nothing is fitted; a place of the
/// surface has the colours of those training photographs that see it from nearly the same direction.
///
/// A photograph's penalty is
///     (angle + resolution * octaves) / share
/// with the angle at the place between the photograph's camera and the eye; the octaves by which the photograph is
/// coarser than the picture; and the share of the photograph's pixels around the place that see it (a test of depths),
/// less towards the photograph's border. Of the k + 1 smallest penalties p the last is the threshold t, and the other
/// photographs have weights in proportion to 1 / p - 1 / t: continuous wherever photographs come and go.
class Lumigraph {
public:
    /// Keeps the photographs in memory with their depths. The dataset must outlive it.
    Lumigraph(const Dataset& dataset, const std::vector<uint32_t>& views, TargetSpace space,
              const LumigraphOptions& options = {});

    /// A photograph that counts.
    struct Part {
        uint32_t photograph;  ///< position in the views
        double penalty;
        double weight;  ///< all add up to 1
        Vec3f colour;
    };
    /// The photographs of what a pixel of the camera sees, least penalty first; none if no photograph shows it.
    std::vector<Part> parts(const Camera& camera, const RasterPixel& pixel) const;
    /// rgb [height][width][3] out. What no photograph shows has the mean colour of all photographs.
    void shade(const Camera& camera, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb) const;

private:
    struct Eye {
        Vec3d place;
        double focal;  ///< pixels
    };
    static Eye eye_of(const Camera& camera);
    /// A photograph that a triangle faces.
    struct Candidate {
        uint32_t photograph;
        double least;  ///< no smaller penalty anywhere on the triangle
        SurfacePhotograph::Plane plane;
    };
    /// Ascending in `least`.
    void find_candidates(const Eye& eye, uint32_t triangle, std::vector<Candidate>& out) const;
    void find_parts(const Eye& eye, const Vec3d& place, const std::vector<Candidate>& candidates,
                    std::vector<Part>& out) const;
    /// One with an infinite penalty does not show the place.
    Part seen_by(const Candidate& candidate, const Eye& eye, const Vec3d& place) const;
    Vec3d place_of(const RasterPixel& pixel) const;

    const Mesh* mesh_;
    LumigraphOptions options_;
    std::vector<SurfacePhotograph> photographs_;
    std::vector<Eye> eyes_;  ///< of the photographs
    float scale_;
    Vec3f mean_ = Vec3f::Zero();
};

/// As gaussian_process_of().
Contestant lumigraph_of(const Dataset& dataset, const std::vector<uint32_t>& views, TargetSpace space,
                        const LumigraphOptions& options = {});

}  // namespace radiafit::fits
