#include "dataset/texel_shading.h"

namespace radiafit {

TexelShading::TexelShading(const Dataset& dataset, const std::vector<uint32_t>& views) {
    for (const uint32_t view : views) views_.push_back(&dataset.views.at(view));
}

TexelShading::Place TexelShading::place(const Atlas& atlas, uint32_t texel) {
    return {atlas.position(texel).cast<double>(), make_frame(atlas.normal(texel))};
}

TexelShading::Lit TexelShading::lit(const Place& place, const View& view) {
    const Light& light = *view.light;
    return {place.frame.to_local(light.direction_from(place.position).cast<float>()),
            place.frame.to_local(view.direction_to_camera(place.position).cast<float>()),
            light.irradiance_at(place.position).cast<float>()};
}

}  // namespace radiafit
