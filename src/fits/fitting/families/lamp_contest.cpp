#include "fitting/families/lamp_contest.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "basis/basis_texels.h"
#include "eval/metrics.h"
#include "eval/safe_relighting.h"
#include "fitting/families/fit_lamp_texels.h"
#include "fitting/resolve_options.h"
#include "fitting/solvers/solver.h"
#include "fitting/tune.h"
#include "samples/picked_texels.h"

namespace radiafit::fits {
namespace {

constexpr size_t most_texels = 16000;  // in one row, which may not be longer than 16384

/// Some of the surface's texels, as an atlas of their own.
struct FewTexels {
    std::unique_ptr<Atlas> whole;
    std::vector<uint32_t> numbers;  ///< in the whole, ascending
    std::unique_ptr<GridAtlas> atlas;

    FewTexels(const Dataset& dataset, int side) : whole(texel_atlas(dataset, side)) {
        const SurfaceExtent extent = dataset.has_grid() ? extent_of(dataset.grid) : extent_of(dataset.mesh);
        numbers = draw_basis_texels(*whole, extent, most_texels, 1, 0).everywhere;
        std::ranges::sort(numbers);
        std::vector<Vec3f> positions, normals;
        for (const uint32_t t : numbers) {
            positions.push_back(whole->position(t));
            normals.push_back(whole->normal(t));
        }
        atlas = std::make_unique<GridAtlas>(int(numbers.size()), 1, std::move(positions), std::move(normals),
                                            std::vector<uint8_t>());
    }
};

/// Samples of few texels under some views.
struct FewSamples {
    std::unique_ptr<TexelSource> all;
    SharedTexels samples;

    FewSamples(const Dataset& dataset, const FewTexels& few, const std::vector<uint32_t>& views,
               const FitRequest& request) {
        std::vector<bool> wanted(few.whole->texel_count());
        for (const uint32_t t : few.numbers) wanted[t] = true;
        all = gather_some(dataset, *few.whole, views, request, wanted);
        samples.source = std::make_unique<PickedTexels>(*all, few.numbers);
        samples.texels = few.numbers;
    }
};

ErrorSums errors_of(const Contestant& contestant, const Dataset& dataset, const std::vector<uint32_t>& views,
                    const FewTexels& few, const TexelSource& truth) {
    std::vector<RasterPixel> pixels(few.numbers.size());
    for (uint32_t i = 0; i < pixels.size(); ++i) pixels[i].triangle = i;
    std::vector<std::vector<float>> shown(views.size());
    parallel_for(views.size(), 1,
                 [&](size_t i, int worker) { contestant.shade(dataset.views[views[i]], pixels, shown[i], worker); });
    const auto stored = [&](float light, double gain) {
        return std::clamp(encode(dataset.encoding, double(light) / gain), 0.0, 1.0);
    };
    ErrorSums sums;
    TexelSamples samples;
    for (uint32_t begin = 0; begin < truth.texel_count(); begin += TexelSource::block) {
        truth.read(begin, samples);
        for (size_t t = 0; t + 1 < samples.first.size(); ++t)
            for (const TexelRadiance& s : samples.of(t))
                for (size_t c = 0; c < 3; ++c) {
                    const double gain = dataset.views[views[s.image]].gain[c];
                    sums.add(stored(shown[s.image][3 * (begin + t) + c], gain) - stored(s.value[c], gain));
                }
    }
    return sums;
}

}  // namespace

std::vector<ContestResult> lamp_contest(const Dataset& dataset, const std::vector<FitSetting>& settings,
                                        const Given& given, const FitRequest& request) {
    const auto every = size_t(left_out_every(dataset, {}));
    std::vector<uint32_t> fitted, judged;
    const std::vector<uint32_t> all = fitted_views(dataset, request);
    for (size_t i = 0; i < all.size(); ++i) (i % every == every / 2 ? judged : fitted).push_back(all[i]);
    FitSetting of_user;
    for (const FitOption& option : fit_options())
        if (given(option.first_flag().c_str())) of_user.emplace_back(option.name, option.text(request));
    const FitRequest plain;
    const FewTexels few(dataset, given("--surface-side") ? request.model.surface_side : reflectance_side(dataset));
    const FewSamples training(dataset, few, fitted, plain), truth(dataset, few, judged, plain);
    std::vector<ContestResult> out;
    for (const FitSetting& setting : settings) {
        FitSetting whole = setting;
        whole.insert(whole.end(), of_user.begin(), of_user.end());
        FitRequest of_setting = resolved_request(whole, dataset);
        of_setting.prior = PriorKind::none;
        ErrorSums errors;
        if (of_setting.texel_model()) {
            ReflectanceFit fit = solve_reflectance(dataset, of_setting, {}, &fitted, &training.samples).fit;
            errors = errors_of(safe_contestant_of(fit, *few.atlas, dataset, fitted), dataset, judged, few,
                               *truth.samples.source);
        } else {
            const LightBasisFit fit = fit_lamp_texels(dataset, *few.atlas, fitted, training.samples, of_setting);
            errors =
                errors_of(contestant_of(fit, *few.atlas, dataset, fitted), dataset, judged, few, *truth.samples.source);
        }
        FitSetting own = setting;  // what the user did not set
        std::erase_if(own,
                      [&](const auto& option) { return given(find_fit_option(option.first).first_flag().c_str()); });
        if (!std::isnan(errors.psnr())) out.push_back({own, errors.psnr()});
    }
    std::ranges::stable_sort(out, [](const auto& a, const auto& b) { return a.psnr > b.psnr; });
    return out;
}

}  // namespace radiafit::fits
