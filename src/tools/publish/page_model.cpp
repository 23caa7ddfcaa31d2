#include "publish/page_model.h"

#include <cmath>

namespace radiafit::tools {
namespace {

constexpr size_t channels_of_map = 3;

}  // namespace

std::vector<TexelMap> pieces_of(std::span<const TexelMap> maps) {
    std::vector<TexelMap> out;
    for (const TexelMap& map : maps)
        for (size_t first = 0; first < map.channels.size(); first += channels_of_map) {
            const size_t end = std::min(first + channels_of_map, map.channels.size());
            out.push_back({map.file,
                           {map.channels.begin() + ptrdiff_t(first), map.channels.begin() + ptrdiff_t(end)},
                           map.first + first});
        }
    return out;
}

Contestant kept_alive(Contestant contestant, std::shared_ptr<const void> owner) {
    Contestant out = contestant;
    out.shade = [shade = contestant.shade, owner](const View& view, const auto& pixels, std::vector<float>& rgb,
                                                  int worker) { shade(view, pixels, rgb, worker); };
    if (contestant.share_of_fit)
        out.share_of_fit = [share = contestant.share_of_fit, owner](const View& view) { return share(view); };
    return out;
}

float root_mean_square(float error, uint32_t samples) {
    return samples > 0 ? std::sqrt(std::max(0.0f, 2 * error / (3 * float(samples)))) : 0;
}

PageMap knowledge_map(const FitRecord& fit, const Atlas& atlas) {
    std::vector<float> known;
    for (size_t t = 0; t < fit.samples.size(); ++t) {
        known.push_back(std::log2(1 + float(fit.samples[t])));
        known.push_back(root_mean_square(fit.error[t], fit.samples[t]));
    }
    PageMap map{.name = "known", .image = parameter_image(atlas, known, {"", {"samples", "residual"}, 0})};
    map.one_unit = false;
    map.fixed_step = {1.0f / 16, 1.0f / 1024, 0};
    return map;
}

std::vector<PageMap> parameter_maps(std::span<const TexelMap> maps, std::span<const float> parameters,
                                    const Atlas& atlas) {
    std::vector<PageMap> out;
    for (const TexelMap& map : pieces_of(maps)) {
        const std::string name = map.file.substr(0, map.file.find('.'));
        out.push_back({.name = name, .image = parameter_image(atlas, parameters, map)});
        out.back().one_unit = map.channels == map_channels();
    }
    return out;
}

std::vector<float> parameters_of(std::span<const TexelMap> maps, std::span<const PageMap> decoded, const Atlas& atlas) {
    size_t numbers = 0;
    for (const TexelMap& map : maps) numbers += map.channels.size();
    std::vector<float> parameters(atlas.texel_count() * numbers);
    const std::vector<TexelMap> pieces = pieces_of(maps);
    for (size_t i = 0; i < pieces.size(); ++i) take_parameter_image(decoded[i].image, atlas, pieces[i], parameters);
    return parameters;
}

}  // namespace radiafit::tools
