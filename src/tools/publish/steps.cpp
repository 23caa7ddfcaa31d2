#include "publish/steps.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/rng.h"
#include "eval/render.h"
#include "publish/coded_map.h"

namespace radiafit::tools {
namespace {

constexpr size_t views_rendered = 3;
constexpr float noise_share = 0.02f;  // of a map's root mean square

/// sRGB values of some views, one after another.
std::vector<float> pictures(const PageModel& model, const Dataset& dataset, const std::vector<uint32_t>& views) {
    const Contestant contestant = model.shown(model.maps);
    std::vector<std::vector<float>> each(views.size());
    for (size_t i = 0; i < views.size(); ++i) {
        const LightImage image = render(contestant, dataset, dataset.views[views[i]], 1);
        for (const float light : image.rgb)
            each[i].push_back(float(srgb_encode(std::isfinite(light) ? std::clamp(double(light), 0.0, 1.0) : 0.0)));
    }
    std::vector<float> all;
    for (const auto& picture : each) all.insert(all.end(), picture.begin(), picture.end());
    return all;
}

double root_mean_square(const std::vector<float>& values) {
    double sum = 0;
    size_t count = 0;
    for (const float v : values) sum += double(v) * double(v), count += v != 0;
    return count > 0 ? std::sqrt(sum / double(count)) : 0;
}

/// Noise on some channels of a map as it is stored, where it isn't 0. Returns its root mean square.
double add_noise(PageMap& map, size_t first, size_t end) {
    const size_t channels = map.image.channels.size();
    std::vector<float> stored;
    for (size_t i = 0; i < map.image.values.size(); ++i)
        if (i % channels >= first && i % channels < end) stored.push_back(stored_number(map, map.image.values[i]));
    const float most = noise_share * std::sqrt(3.0f) * float(root_mean_square(stored));
    for (size_t i = 0; i < map.image.values.size(); ++i) {
        float& value = map.image.values[i];
        if (value == 0 || i % channels < first || i % channels >= end) continue;
        const float uniform = 2 * random_uniform(0, i) - 1;
        value = number_of(map, stored_number(map, value) + most * uniform);
    }
    return most / std::sqrt(3.0);
}

}  // namespace

std::vector<std::array<float, 3>> map_effects(PageModel& model, const Dataset& dataset,
                                              const std::vector<uint32_t>& training) {
    std::vector<uint32_t> views;
    for (size_t i = 0; i < std::min(views_rendered, training.size()); ++i)
        views.push_back(training[(2 * i + 1) * training.size() / (2 * std::min(views_rendered, training.size()))]);
    const std::vector<float> before = pictures(model, dataset, views);
    std::vector<std::array<float, 3>> effects(model.maps.size(), {0, 0, 0});
    for (size_t m = 0; m < model.maps.size(); ++m) {
        PageMap& map = model.maps[m];
        if (map.fixed_step[0] > 0) continue;
        const size_t channels = map.image.channels.size(), group = map.one_unit ? channels : 1;
        for (size_t first = 0; first < channels; first += group) {
            const std::vector<float> values = map.image.values;
            const double noise = add_noise(map, first, first + group);
            std::vector<float> change = pictures(model, dataset, views);
            for (size_t i = 0; i < change.size(); ++i) change[i] -= before[i];
            map.image.values = values;
            const float effect = noise > 0 ? float(root_mean_square(change) / noise) : 0;
            std::fill_n(effects[m].begin() + ptrdiff_t(first), group, effect);
        }
    }
    return effects;
}

std::vector<std::array<float, 3>> map_steps(const PageModel& model, const std::vector<std::array<float, 3>>& effects,
                                            double rms) {
    size_t groups = 0;
    for (const PageMap& map : model.maps)
        if (map.fixed_step[0] == 0) groups += map.one_unit ? 1 : map.image.channels.size();
    const double each = rms * std::sqrt(12.0 / double(std::max<size_t>(groups, 1)));
    std::vector<std::array<float, 3>> steps(model.maps.size());
    for (size_t m = 0; m < model.maps.size(); ++m)
        for (size_t c = 0; c < 3; ++c) {
            const PageMap& map = model.maps[m];
            const float by_effect = effects[m][c] > 0 ? float(each) / effects[m][c] : map.most_step;
            steps[m][c] = map.fixed_step[c] > 0 ? map.fixed_step[c] : std::min(by_effect, map.most_step);
            if (!std::isfinite(steps[m][c])) steps[m][c] = 1;  // it shows nothing
        }
    return steps;
}

}  // namespace radiafit::tools
