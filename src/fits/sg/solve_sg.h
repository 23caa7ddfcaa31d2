#pragma once
#include <array>
#include <span>
#include <vector>

#include "base/journal.h"
#include "base/range.h"
#include "base/rings.h"
#include "dataset/dataset.h"
#include "geometry/atlas.h"
#include "model/status.h"
#include "samples/sample_list.h"

namespace radiafit::limits {
constexpr Range<int> lobes{1, 4};
constexpr Range<double> lobe_noise{1e-9, 1};
}  // namespace radiafit::limits

/// Diffuse colours and spherical Gaussians by view direction, texel by texel (shaders/model/sg.glsl).
namespace radiafit::fits {

struct SgOptions {
    int lobes = 4;        ///< in [1, 4]: 3 + 6 x lobes numbers per texel
    double noise = 6e-4;  ///< variance of a residual, in units of white: how far samples count against the prior
    int iterations = 8;   ///< of Levenberg and Marquardt, at most
};
/// Throws UserError for a value out of range.
void check_options(const SgOptions& options);

constexpr int sg_parameters(int lobes) { return 3 + 6 * lobes; }

/// The sum of all samples' colours; exact, so that parts of a surface add up to the whole.
struct ColourSum {
    std::array<uint64_t, 3> rgb{};  ///< of Sample::rgb
    uint64_t samples = 0;
    float scale = 0;  ///< SampleList::scale, the same for all parts

    void add(const ColourSum& other);
    Vec3f mean() const;
};

struct SgSolution {
    /// [texels][3 + 6 lobes]: d, then a of every lobe, then (x, y, log lambda) of every lobe. Where nothing was seen,
    /// d is the mean colour of the triangle, or of the surface, and a is 0.
    std::vector<float> parameters;
    std::vector<uint32_t> samples, iterations;  ///< [texels]
    std::vector<float> error;                   ///< [texels] 1/2 sum w r^2, and what the prior adds
    std::vector<Status> status;                 ///< [texels]
    ColourSum colours;
};

/// For every texel the parameters of least 1/2 sum over samples of w |y - m(v)|^2 and prior: d about the triangle's
/// mean colour, a about 0, lobes about the normal and lambda = 5. From greedy starts by batched Levenberg-Marquardt
/// (cpu/texel_fit.h). `up`: as view_frame()'s. The same for any number of threads. `journal` keeps triangles that are
/// finished.
SgSolution solve_sg(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples, const Vec3f& up,
                    const SgOptions& options, Journal* journal = nullptr);

/// Gives texels of triangles that no image shows this colour, where solve_sg() gives the mean of its samples.
/// samples: SgSolution's.
void colour_unseen(const TriangleAtlas& atlas, std::span<const uint32_t> samples, int lobes, const Vec3f& colour,
                   std::vector<float>& parameters);

}  // namespace radiafit::fits
