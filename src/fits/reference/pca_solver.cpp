#include "reference/pca_solver.h"

#include "base/parallel.h"
#include "reference/truncated_svd.h"

namespace radiafit::fits {
namespace {

/// Where a vertex's terms of one channel lie in the parameters.
void put(const TruncatedSvd& svd, const LfmLayout& layout, const std::vector<uint32_t>& view_texels, size_t vertex,
         size_t channel, std::vector<float>& parameters) {
    const size_t stride = layout.stride();
    float* surface = parameters.data() + layout.offset(vertex) + channel;
    float* view = parameters.data() + layout.view_offset(vertex) + channel;
    for (Eigen::Index k = 0; k < layout.terms(); ++k) {
        for (Eigen::Index i = 0; i < svd.g.rows(); ++i) surface[size_t(i) * stride] = float(svd.g(i, k));
        for (size_t i = 0; i < view_texels.size(); ++i)
            view[view_texels[i] * stride] = float(svd.h(Eigen::Index(i), k));
        surface += 4;
        view += 4;
    }
}

}  // namespace

std::vector<PcaFit> pca_solver(const RingResampler& resampler, const LfmLayout& layout, std::span<const int> refills,
                               const std::function<void()>& vertex_done) {
    std::vector<PcaFit> fits(refills.size());
    for (PcaFit& fit : fits) fit.parameters.assign(layout.size(), 0.0f);
    std::vector<ResamplingCounts> counts(layout.problem_count());
    std::vector<DenseLightField> scratch(static_cast<size_t>(thread_count()));
    parallel_for(layout.problem_count(), 1, [&](size_t v, int worker) {
        DenseLightField& field = scratch[size_t(worker)];
        const bool seen = resampler.resample(v, field);
        for (size_t c = 0; c < 3 && seen; ++c) {
            const Eigen::MatrixXd& a = field.channel[c];
            TruncatedSvd svd = truncated_svd(a, layout.terms());
            int done = 0;
            for (size_t i = 0; i < refills.size(); ++i) {
                for (; done < refills[i]; ++done) refine_measured(a, field.invented, svd);
                put(svd, layout, resampler.view_texels(), v, c, fits[i].parameters);
            }
        }
        counts[v] = field.counts;
        if (vertex_done) vertex_done();
    });
    for (PcaFit& fit : fits)
        for (const ResamplingCounts& c : counts) fit.resampling += c;
    return fits;
}

}  // namespace radiafit::fits
