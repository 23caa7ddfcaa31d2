#include "reference/pca_solver.h"

#include "base/parallel.h"
#include "reference/truncated_svd.h"

namespace radiafit::fits {
namespace {

TruncatedSvd factorize(Eigen::MatrixXd& a, const Eigen::MatrixXd& invented, int terms, int refills) {
    TruncatedSvd svd = truncated_svd(a, terms);
    for (int i = 0; i < refills; ++i) {
        a = (invented.array() > 0).select(svd.g * svd.h.transpose(), a);
        refine(a, svd);
    }
    return svd;
}

}  // namespace

PcaFit pca_solver(const RingResampler& resampler, const LfmLayout& layout, int refills,
                  const std::function<void()>& vertex_done) {
    const std::vector<uint32_t>& view_texels = resampler.view_texels();
    const size_t stride = layout.stride();
    PcaFit fit;
    fit.parameters.assign(layout.size(), 0.0f);
    std::vector<ResamplingCounts> counts(layout.problem_count());
    std::vector<DenseLightField> scratch(static_cast<size_t>(thread_count()));
    parallel_for(layout.problem_count(), 1, [&](size_t v, int worker) {
        DenseLightField& field = scratch[size_t(worker)];
        const bool seen = resampler.resample(v, field);
        for (size_t c = 0; c < 3 && seen; ++c) {
            const TruncatedSvd svd = factorize(field.channel[c], field.invented, layout.terms(), refills);
            float* surface = fit.parameters.data() + layout.offset(v) + c;
            float* view = fit.parameters.data() + layout.view_offset(v) + c;
            for (Eigen::Index k = 0; k < layout.terms(); ++k) {
                for (Eigen::Index i = 0; i < svd.g.rows(); ++i) surface[size_t(i) * stride] = float(svd.g(i, k));
                for (size_t i = 0; i < view_texels.size(); ++i)
                    view[view_texels[i] * stride] = float(svd.h(Eigen::Index(i), k));
                surface += 4;
                view += 4;
            }
        }
        counts[v] = field.counts;
        if (vertex_done) vertex_done();
    });
    for (const ResamplingCounts& c : counts) fit.resampling += c;
    return fit;
}

}  // namespace radiafit::fits
