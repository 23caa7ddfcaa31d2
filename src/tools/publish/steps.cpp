#include "publish/steps.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/rng.h"
#include "eval/pixel_areas.h"
#include "publish/choices.h"
#include "publish/coded_map.h"

namespace radiafit::tools {
namespace {

constexpr size_t views_rendered = 3;
constexpr size_t pixels_of_view = 1 << 14;  // at most, of those that see the surface: its texture's mean is wanted
constexpr float noise_share = 0.02f;        // of a map's root mean square

/// Some of the pixels of some views.
class Pictures {
public:
    Pictures(const Dataset& dataset, const std::vector<uint32_t>& training) : dataset_(dataset) {
        for (const uint32_t v : spread(training, views_rendered)) views_.push_back(v);
        seen_.resize(views_.size());
        parallel_for(views_.size(), 1, [&](size_t i, int) {
            Rasterizer rasterizer;
            std::vector<RasterPixel> all = seen_pixels(dataset, dataset.views[views_[i]], rasterizer);
            std::erase_if(all, [](const RasterPixel& p) { return p.triangle == no_triangle; });
            const size_t count = std::min(all.size(), pixels_of_view);
            for (size_t k = 0; k < count; ++k) seen_[i].push_back(all[k * all.size() / count]);
        });
    }

    /// sRGB values of all of them, one after another.
    std::vector<float> shown(const Contestant& contestant) const {
        std::vector<std::vector<float>> each(views_.size());
        parallel_for(views_.size(), 1, [&](size_t i, int worker) {
            contestant.shade(dataset_.views[views_[i]], seen_[i], each[i], worker);
            for (float& value : each[i]) {
                const double light =
                    contestant.space == TargetSpace::stored ? decode(dataset_.encoding, value) : double(value);
                value = float(srgb_encode(std::isfinite(light) ? std::clamp(light, 0.0, 1.0) : 0.0));
            }
        });
        std::vector<float> all;
        for (const auto& picture : each) all.insert(all.end(), picture.begin(), picture.end());
        return all;
    }

private:
    const Dataset& dataset_;
    std::vector<uint32_t> views_;
    std::vector<std::vector<RasterPixel>> seen_;
};

double root_mean_square(const std::vector<float>& values) {
    double sum = 0;
    size_t count = 0;
    for (const float v : values) sum += double(v) * double(v), count += v != 0;
    return count > 0 ? std::sqrt(sum / double(count)) : 0;
}

/// Noise on some channels of a map as it is stored, where it isn't 0. Returns its root mean square.
double add_noise(PageMap& map, size_t first, size_t end) {
    const size_t channels = map.image.channels.size(), pixels = map.image.values.size() / channels;
    std::vector<float>& values = map.image.values;
    std::vector<float> stored;
    stored.reserve(pixels * (end - first));
    for (size_t i = 0; i < pixels; ++i)
        for (size_t c = first; c < end; ++c) stored.push_back(stored_number(map, values[i * channels + c]));
    const float most = noise_share * std::sqrt(3.0f) * float(root_mean_square(stored));
    constexpr size_t grain = 1 << 14;
    parallel_for(pixels, grain, [&](size_t pixel, int) {
        for (size_t i = pixel * channels + first; i < pixel * channels + end; ++i) {
            if (values[i] == 0) continue;
            const float uniform = 2 * random_uniform(0, i) - 1;
            values[i] = number_of(map, stored_number(map, values[i]) + most * uniform);
        }
    });
    return most / std::sqrt(3.0);
}

/// Calls body(map, first channel, end) for what has one step: a map, or each of its channels.
template <class Body>
void for_each_step(const PageModel& model, const Body& body) {
    for (size_t m = 0; m < model.maps.size(); ++m) {
        const PageMap& map = model.maps[m];
        if (map.fixed_step[0] > 0) continue;
        const size_t channels = map.image.channels.size(), group = map.one_unit ? channels : 1;
        for (size_t first = 0; first < channels; first += group) body(m, first, first + group);
    }
}

}  // namespace

size_t chosen_steps(const PageModel& model) {
    size_t count = 0;
    for_each_step(model, [&](size_t, size_t, size_t) { ++count; });
    return count;
}

std::vector<std::array<float, 3>> map_effects(PageModel& model, const Dataset& dataset,
                                              const std::vector<uint32_t>& training,
                                              const std::function<void()>& measured) {
    const Pictures pictures(dataset, training);
    const ShownMaps shown = model.shown(model.maps);
    const std::vector<float> before = pictures.shown(shown.contestant);
    std::vector<std::array<float, 3>> effects(model.maps.size(), {0, 0, 0});
    for_each_step(model, [&](size_t m, size_t first, size_t end) {
        PageMap& map = model.maps[m];
        const std::vector<float> values = map.image.values;
        const double noise = add_noise(map, first, end);
        if (shown.change) shown.change(m, map);
        std::vector<float> change =
            pictures.shown(shown.change ? shown.contestant : model.shown(model.maps).contestant);
        for (size_t i = 0; i < change.size(); ++i) change[i] -= before[i];
        map.image.values = values;
        if (shown.change) shown.change(m, map);
        const float effect = noise > 0 ? float(root_mean_square(change) / noise) : 0;
        std::fill_n(effects[m].begin() + ptrdiff_t(first), end - first, effect);
        measured();
    });
    return effects;
}

std::vector<std::array<float, 3>> map_steps(const PageModel& model, const std::vector<std::array<float, 3>>& effects,
                                            double rms) {
    const double each = rms * std::sqrt(12.0 / double(std::max<size_t>(chosen_steps(model), 1)));
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
