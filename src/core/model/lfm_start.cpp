#include "model/lfm_start.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/rng.h"

namespace radiafit {
std::vector<float> lfm_start(const LfmLayout& layout, std::span<const float> mean, uint64_t seed) {
    std::vector<float> p(layout.size(), 0.0f);
    const size_t stride = layout.stride();
    parallel_for(layout.problem_count(), 64, [&](size_t v, int) {
        for (size_t at = layout.offset(v); at < layout.view_offset(v); at += stride)
            for (int c = 0; c < 3; ++c) p[at + c] = mean[3 * v + c];
        const uint64_t to_whole = layout.whole_offset(v) - layout.offset(v);
        for (size_t at = layout.view_offset(v); at < layout.offset(v + 1); at += stride)
            for (size_t i = 0; i < stride; ++i)
                if (i % 4 < 3) p[at + i] = i < 4 ? 1.0f : 0.6f * random_uniform(seed, to_whole + at + i) - 0.3f;
    });
    return p;
}

float scaled_lambda_view(const LfmOptions& o, size_t ring_texels, float mean) {
    if (!o.corrections.scaled_lambda_view) return o.lambda_view;
    return o.lambda_view * float(ring_texels) / float(o.view_side * o.view_side) * std::max(mean * mean, 1e-3f);
}

double inverse_density(const LfmOptions& o, size_t ring_texels, uint32_t samples) {
    return o.corrections.normalized ? double(ring_texels) / samples : 1;
}

}  // namespace radiafit
