#include "eval/safe_relighting.h"

#include <algorithm>

#include "base/parallel.h"
#include "dataset/texel_shading.h"
#include "dataset/view_directions.h"
#include "geometry/direction_hull.h"

namespace radiafit {

SafeRelighting::SafeRelighting(const Dataset& dataset, const std::vector<uint32_t>& training, const Atlas& atlas,
                               const ReflectanceFit& fit)
    : SafeRelighting(dataset, training, atlas, fit, std::vector<Bounds>(atlas.texel_count())) {
    find_bounds();
}

SafeRelighting::SafeRelighting(const Dataset& dataset, const std::vector<uint32_t>& training, const Atlas& atlas,
                               const ReflectanceFit& fit, std::vector<Bounds> bounds)
    : renderer_(atlas, fit),
      dataset_(&dataset),
      atlas_(&atlas),
      fit_(&fit),
      centre_(surface_centre(dataset.mesh, dataset.grid)),
      bounds_(std::move(bounds)) {
    for (const uint32_t v : training) {
        const View& view = dataset.views[v];
        training_.push_back(&view);
        cameras_.push_back(view.direction_to_camera(centre_));
        lamps_.push_back(view.light->direction_from(centre_));
    }
}

void SafeRelighting::find_bounds() {
    const auto seen = [&](size_t texel) { return fit_->samples[texel] > 0; };
    parallel_for(bounds_.size(), 256, [&](size_t texel, int) {
        if (seen(texel)) bounds_[texel] = bounds_of(uint32_t(texel));
    });
    Vec3d sum = Vec3d::Zero();
    size_t count = 0;
    for (size_t t = 0; t < bounds_.size(); ++t)
        if (seen(t)) sum += bounds_[t].albedo.cast<double>(), ++count;
    const Vec3f mean = count > 0 ? Vec3f((sum / double(count)).cast<float>()) : Vec3f::Zero();
    for (size_t t = 0; t < bounds_.size(); ++t)
        if (!seen(t)) bounds_[t].albedo = mean;
}

SafeRelighting::Bounds SafeRelighting::bounds_of(uint32_t texel) const {
    const size_t n = size_t(fit_->options.model->parameters);
    const std::span<const float> p(&fit_->parameters[size_t(texel) * n], n);
    const auto place = TexelShading::place(*atlas_, texel);
    Bounds out;
    float squares = 0;
    for (const View* view : training_) {
        const TexelShading::Lit lit = TexelShading::lit(place, *view);
        const Vec3f value = shown_value(fit_->options, p, lit.u, lit.v);
        if (!(lit.u.z() > 0 && lit.v.z() > 0)) continue;
        squares += lit.u.z() * lit.u.z();
        for (int c = 0; c < 3; ++c) {
            // no brighter than the image can hold, beyond which it says nothing; not-a-number counts as none
            const float holds = float(view->peak * view->gain[0]) / std::max(lit.irradiance[c], 1e-20f);
            const float seen = std::min(std::max(0.0f, value[c]), holds);
            out.albedo[c] += seen * lit.u.z();
            out.brightest[c] = std::max(out.brightest[c], seen);
        }
    }
    if (squares > 0) out.albedo /= squares;
    return out;
}

double SafeRelighting::share_of_fit(const View& view) const {
    if (cameras_.empty()) return 0;
    const double outside = std::max(angle_outside(cameras_, view.direction_to_camera(centre_)),
                                    angle_outside(lamps_, view.light->direction_from(centre_)));
    return share_at(outside);
}

double SafeRelighting::share_at(double outside) {
    return std::clamp(1 - std::max(0.0, outside - trusted) / fade, 0.0, 1.0);
}

Vec3f SafeRelighting::colour_of(uint32_t texel, const View& view, float share) const {
    const TexelShading::Lit lit = TexelShading::lit(TexelShading::place(*atlas_, texel), view);
    if (!(lit.u.z() > 0 && lit.v.z() > 0)) return Vec3f::Zero();
    const Bounds& bounds = bounds_[texel];
    Vec3f colour = bounds.albedo * lit.u.z();
    if (fit_->samples[texel] > 0) {
        const size_t n = size_t(fit_->options.model->parameters);
        const Vec3f value = shown_value(fit_->options, {&fit_->parameters[size_t(texel) * n], n}, lit.u, lit.v);
        const Vec3f most_bright = most * bounds.brightest;
        for (int c = 0; c < 3; ++c) {
            const float fitted = std::min(std::max(0.0f, value[c]), most_bright[c]);
            colour[c] = std::min(share * fitted + (1 - share) * colour[c], most_bright[c]);
        }
    }
    return colour.cwiseProduct(lit.irradiance);
}

void SafeRelighting::shade(const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb) const {
    rgb.assign(3 * pixels.size(), 0.0f);
    const float share = float(share_of_fit(view));
    for (size_t i = 0; i < pixels.size(); ++i)
        if (pixels[i].triangle != no_triangle)
            Vec3f::Map(&rgb[3 * i]) = colour_of(renderer_.texel_of(pixels[i]), view, share);
}

Contestant safe_contestant_of(const ReflectanceFit& fit, const Atlas& atlas, const Dataset& dataset,
                              const std::vector<uint32_t>& training) {
    return contestant_of(std::make_shared<const SafeRelighting>(dataset, training, atlas, fit));
}

Contestant contestant_of(std::shared_ptr<const SafeRelighting> safe) {
    return {
        [safe](const View& view, const auto& pixels, std::vector<float>& rgb, int) { safe->shade(view, pixels, rgb); },
        TargetSpace::linear, [safe](const View& view) { return safe->share_of_fit(view); }};
}

}  // namespace radiafit
