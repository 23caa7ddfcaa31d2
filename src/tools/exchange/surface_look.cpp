#include "exchange/surface_look.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "dataset/texel_shading.h"
#include "eval/safe_relighting.h"
#include "eval/texel_pixels.h"
#include "fitting/family.h"
#include "model/lfm.h"

namespace radiafit::tools {
namespace {

constexpr size_t most_cameras = 24;  // evenly among the training views, to take a mean over

std::shared_ptr<const Atlas> not_owned(const Atlas& atlas) { return {std::shared_ptr<const void>(), &atlas}; }

Vec3f not_below_zero(const Vec3f& colour) {
    return colour.unaryExpr([](float x) { return std::max(0.0f, x); });  // not-a-number becomes 0, too
}

/// Sums of colours and weights [texels], camera after camera, so that threads change nothing.
struct FacingMean {
    std::vector<Vec3f> colour;
    std::vector<float> weight;

    void add(const TriangleAtlas& atlas, const View& view, const std::vector<float>& rgb, const Contestant& contestant,
             Encoding encoding) {
        const Vec3f eye = view.camera.center().cast<float>();
        parallel_for(colour.size(), 4096, [&](size_t t, int) {
            if (!atlas.usable(uint32_t(t))) return;
            const Vec3f to_eye = (eye - atlas.position(uint32_t(t))).normalized();
            const float facing = to_eye.dot(atlas.normal(uint32_t(t)));
            if (!(facing > 0)) return;
            Vec3f seen = Vec3f::Map(&rgb[3 * t]);
            if (contestant.space == TargetSpace::stored)
                for (float& x : seen) x = float(decode(encoding, double(x)));
            if (!seen.allFinite()) return;
            colour[t] += facing * not_below_zero(seen);
            weight[t] += facing;
        });
    }
    /// Texels that face no camera have the mean of the others.
    std::vector<Vec3f> mean() const {
        Vec3d sum = Vec3d::Zero();
        double all = 0;
        for (size_t t = 0; t < colour.size(); ++t) sum += colour[t].cast<double>(), all += double(weight[t]);
        const Vec3f other = all > 0 ? Vec3f((sum / all).cast<float>()) : Vec3f::Zero();
        std::vector<Vec3f> out(colour.size());
        for (size_t t = 0; t < out.size(); ++t) out[t] = weight[t] > 0 ? Vec3f(colour[t] / weight[t]) : other;
        return out;
    }
};

SurfaceLook mean_look(const Contestant& contestant, std::shared_ptr<const TriangleAtlas> atlas, const Dataset& dataset,
                      const std::vector<uint32_t>& training, SurfaceLookup lookup) {
    const std::vector<RasterPixel> centres = texel_pixels(*atlas);
    FacingMean sums{std::vector<Vec3f>(centres.size(), Vec3f::Zero()), std::vector<float>(centres.size(), 0.0f)};
    const size_t cameras = std::min(most_cameras, training.size());
    std::vector<std::vector<float>> shown(static_cast<size_t>(thread_count()));
    for (size_t first = 0; first < cameras; first += shown.size()) {
        const size_t count = std::min(shown.size(), cameras - first);
        const auto view = [&](size_t i) { return dataset.views[training[(first + i) * training.size() / cameras]]; };
        parallel_for(count, 1, [&](size_t i, int worker) { contestant.shade(view(i), centres, shown[i], worker); });
        for (size_t i = 0; i < count; ++i) sums.add(*atlas, view(i), shown[i], contestant, dataset.encoding);
    }
    SurfaceLook look;
    look.atlas = std::move(atlas);
    look.lookup = lookup;
    look.base_colour = sums.mean();
    look.meaning = "mean of what the fit shows to the cameras that were fitted, by the cosine under which they see it";
    return look;
}

struct Lobe {
    float peak = 0;      ///< of the brightest channel
    float exponent = 0;  ///< weighted mean
};

float roughness(const Lobe& lobe) {
    return lobe.peak < least_lobe || !std::isfinite(lobe.exponent) ? 1.0f : roughness_of(double(lobe.exponent));
}

Lobe lobe_of(const TexelModel& model, std::span<const float> p) {
    const auto last = p.subspan(size_t(3 * (model.basis - 1)), 3);
    return {std::ranges::max(last), *model.lobe_exponent(p)};
}

Lobe lobe_of(std::span<const float> p, size_t lobes) {
    Lobe out;
    float weights = 0, logarithms = 0;
    for (size_t l = 0; l < lobes; ++l) {
        const float peak = std::max(0.0f, std::ranges::max(p.subspan(3 + 3 * l, 3)));
        weights += peak;
        logarithms += peak * p[3 + 3 * lobes + 3 * l + 2];
        out.peak = std::max(out.peak, peak);
    }
    out.exponent = std::exp(weights > 0 ? logarithms / weights : 0.0f);
    return out;
}

}  // namespace

float roughness_of(double exponent) { return float(std::pow(2 * std::max(0.0, exponent) + 1, -0.25)); }

SurfaceLook look_of(const ReflectanceFit& fit, const Atlas& atlas, const Dataset& dataset,
                    const std::vector<uint32_t>& training) {
    const TexelModel& model = *fit.options.model;
    const SafeRelighting safe(dataset, training, atlas, fit);
    SurfaceLook look;
    look.atlas = not_owned(atlas);
    look.lookup = fit.surface;
    look.albedo = true;
    const bool of_light = fit.options.curve == ValueCurve::linear;
    const bool has_diffuse = model.diffuse && of_light;
    look.meaning = has_diffuse ? "diffuse albedo, " + model.coefficient_names[size_t(*model.diffuse)]
                               : "the Lambertian albedo nearest to the model over the images that were fitted";
    const size_t n = size_t(model.parameters);
    const bool has_lobe =
        of_light && !fit.parameters.empty() && model.lobe_exponent({fit.parameters.data(), n}).has_value();
    if (has_lobe) look.meaning += "; roughness = (2n + 1)^(-1/4) of the lobe's exponent n";
    for (size_t t = 0; t < atlas.texel_count(); ++t) {
        const std::span<const float> p(&fit.parameters[t * n], n);
        const bool seen = fit.samples[t] > 0;
        Vec3f colour = safe.bounds()[t].albedo;
        if (seen && has_diffuse) colour = Vec3f::Map(&p[size_t(3 * *model.diffuse)]);
        look.base_colour.push_back(not_below_zero(colour));
        if (has_lobe) look.roughness.push_back(seen ? roughness(lobe_of(model, p)) : 1.0f);
    }
    return look;
}

SurfaceLook look_of(const SgFit& fit, const TriangleAtlas& atlas, const Dataset& dataset,
                    const std::vector<uint32_t>&) {
    SurfaceLook look;
    look.atlas = not_owned(atlas);
    look.lookup = fit.surface;
    look.meaning =
        "diffuse colour under the light that stayed; roughness = (2 lambda + 1)^(-1/4) of the lobes' mean sharpness "
        "lambda";
    const size_t n = size_t(sg_parameters(fit.lobes));
    for (size_t t = 0; t < atlas.texel_count(); ++t) {
        const std::span<const float> p(&fit.parameters[t * n], n);
        Vec3f colour = Vec3f::Map(p.data());
        if (fit.space == TargetSpace::stored)
            for (float& x : colour) x = float(decode(dataset.encoding, double(x)));
        look.base_colour.push_back(not_below_zero(colour));
        look.roughness.push_back(roughness(lobe_of(p, size_t(fit.lobes))));
    }
    return look;
}

SurfaceLook look_of(const ViewBasisFit& fit, const TriangleAtlas& atlas, const Dataset& dataset,
                    const std::vector<uint32_t>& training) {
    const std::shared_ptr<const TriangleAtlas> same(std::shared_ptr<const void>(), &atlas);
    return mean_look(contestant_of(fit, atlas), same, dataset, training, fit.surface);
}

SurfaceLook look_of(const LightBasisFit& fit, const Atlas& atlas, const Dataset& dataset,
                    const std::vector<uint32_t>& training) {
    const std::vector<RasterPixel> centres = texel_pixels(atlas);
    const Contestant contestant = contestant_of(fit, atlas, dataset, training);
    std::vector<Vec3f> sums(centres.size(), Vec3f::Zero());
    std::vector<float> squares(centres.size(), 0.0f), shown;
    const size_t lamps = std::min(most_cameras, training.size());
    for (size_t i = 0; i < lamps; ++i) {
        const View& view = dataset.views[training[i * training.size() / lamps]];
        contestant.shade(view, centres, shown, 0);
        parallel_for(centres.size(), 4096, [&](size_t t, int) {
            if (!atlas.usable(uint32_t(t))) return;
            const TexelShading::Lit lit = TexelShading::lit(TexelShading::place(atlas, uint32_t(t)), view);
            if (!(lit.u.z() > 0)) return;
            sums[t] += lit.u.z() * Vec3f::Map(&shown[3 * t]).cwiseQuotient(lit.irradiance);
            squares[t] += lit.u.z() * lit.u.z();
        });
    }
    SurfaceLook look;
    look.atlas = not_owned(atlas);
    look.lookup = fit.surface;
    look.albedo = true;
    look.meaning = "the Lambertian albedo nearest to the model under lamps that were fitted";
    for (size_t t = 0; t < sums.size(); ++t)
        look.base_colour.push_back(squares[t] > 0 ? not_below_zero(sums[t] / squares[t]) : Vec3f::Zero());
    return look;
}

SurfaceLook look_of(const LightFieldFit& fit, const Dataset& dataset, const std::vector<uint32_t>& training) {
    auto atlas = std::make_shared<const TriangleAtlas>(surface_atlas(dataset.mesh, fit.options));
    return mean_look(contestant_of(fit, dataset.mesh), atlas, dataset, training, fit.surface);
}

SurfaceLook look_of(Fitted& fitted) {
    const Dataset& dataset = fitted.dataset();
    const std::vector<uint32_t> training = fitted_views(dataset, fitted.record());
    return std::visit(
        [&](const auto& m) {
            if constexpr (requires { m.atlas; })
                return look_of(m.fit, *m.atlas, dataset, training);
            else
                return look_of(m.fit, dataset, training);
        },
        fitted.model);
}

}  // namespace radiafit::tools
