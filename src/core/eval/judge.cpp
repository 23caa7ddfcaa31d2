#include "eval/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include "base/error.h"
#include "base/parallel.h"
#include "base/wording.h"
#include "dataset/view_directions.h"
#include "eval/exposure.h"
#include "eval/ssim.h"

namespace radiafit {
namespace {

// The photographs as they are stored: the stream would apply the gains.
Dataset without_gains(Dataset dataset) {
    for (View& view : dataset.views) view.gain = 1;
    return dataset;
}

bool has_gains(const Dataset& dataset) {
    for (const View& view : dataset.views)
        if (view.gain != 1) return true;
    return false;
}

bool has_channel_gains(const Dataset& dataset) {
    for (const View& view : dataset.views)
        if (!view.gain.uniform()) return true;
    return false;
}

/// srgb_decode() of what a photograph of 8 bits holds, bytes in 255ths as floats: by a table where it is one of them.
double light_of_byte(float stored) {
    static const auto table = [] {
        std::array<std::pair<float, double>, 256> entries;
        for (size_t i = 0; i < entries.size(); ++i) {
            const float value = float(257 * i) * ((1.0f / 255) / 257.0f);  // as TargetImage has it
            entries[i] = {value, srgb_decode(double(value))};
        }
        return entries;
    }();
    const auto index = size_t(std::clamp(stored, 0.0f, 1.0f) * 255 + 0.5f);
    return table[index].first == stored ? table[index].second : srgb_decode(double(stored));
}

// One thread's tools.
class Bench {
public:
    Bench(const Dataset& dataset, ImageStream stream, int pixel_points)
        : dataset_(&dataset),
          has_gains_(has_gains(dataset)),
          has_channel_gains_(has_channel_gains(dataset)),
          stream_(std::move(stream)),
          areas_(dataset, pixel_points) {}

    JudgedView compare(const Contestant& contestant, uint32_t index, int worker) {
        const View& view = dataset_->views.at(index);
        stream_.load(index, image_);
        areas_.shade(contestant, view, worker);
        const std::vector<RasterPixel>& seen = areas_.centres();
        const std::vector<float>& rgb = areas_.rgb();

        JudgedView out;
        out.width = view.camera.width;
        out.height = view.camera.height;
        out.gain = view.gain;
        const size_t pixels = seen.size();
        out.photograph.resize(3 * pixels);
        out.foreground.resize(pixels);
        if (view.mask_offset && !dataset_->has_grid()) out.missing.resize(pixels);
        const float scale = image_.scale16();
        for (size_t i = 0; i < pixels; ++i) {
            const auto channels = image_.channel16(i);
            for (size_t c = 0; c < 3; ++c) out.photograph[3 * i + c] = clamped(float(channels[c]) * scale);
            out.foreground[i] = seen[i].triangle != no_triangle && image_.masked_in(i);
            if (!out.missing.empty()) out.missing[i] = seen[i].triangle == no_triangle && image_.masked_in(i);
        }
        if (has_gains_ && view.held_out) out.gain = best_gain(contestant.space, out);
        out.render.assign(3 * pixels, 0.0f);
        // Values that already are what is stored go through no transfer function and back.
        const bool as_they_are = out.gain == 1 && contestant.space == TargetSpace::stored;
        for (size_t i = 0; i < pixels; ++i)
            for (size_t c = 0; c < 3 && out.foreground[i]; ++c) {
                const float value = rgb[3 * i + c];
                out.render[3 * i + c] =
                    as_they_are ? clamped(value)
                                : exposed(dataset_->encoding, 1 / out.gain[c], light(contestant.space, value));
            }
        return out;
    }

    /// How the contestant's error bars fare on the view compared last.
    ErrorBarFigures error_bars(const Contestant& contestant, const View& view, const JudgedView& judged) {
        ErrorBarFigures out;
        if (!contestant.error_bars) return out;
        contestant.error_bars(view, areas_.centres(), bars_);
        for (size_t i = 0; i < judged.foreground.size(); ++i) {
            if (!judged.foreground[i]) continue;
            Vec3f error;
            float stored[3];
            for (size_t c = 0; c < 3; ++c) {
                const float photograph = judged.photograph[3 * i + c];
                error[Eigen::Index(c)] =
                    areas_.rgb()[3 * i + c] - exposed_alike(contestant.space, photograph, judged.gain[c]);
                stored[c] = judged.render[3 * i + c] - photograph;
            }
            out.add(bars_[i], error, stored);
        }
        return out;
    }

    const std::vector<RasterPixel>& seen() const { return areas_.centres(); }  ///< of the view compared last

private:
    double light(TargetSpace space, float value) const {
        return space == TargetSpace::linear ? value : decode(dataset_->encoding, value);
    }

    /// A photograph's stored value in the contestant's exposure and space.
    float exposed_alike(TargetSpace space, float stored, double gain) const {
        const double linear = gain * decode(dataset_->encoding, stored);
        return float(space == TargetSpace::linear ? linear : exposed(dataset_->encoding, 1, linear));
    }

    /// The gain that suits the channels from `first` to `last` best, near the gain `around`.
    double best_gain(TargetSpace space, const JudgedView& view, size_t first, size_t last, double around) const {
        std::vector<float> values, photograph;
        for (size_t i = 0; i < view.foreground.size(); ++i)
            for (size_t c = 3 * i + first; c <= 3 * i + last && view.foreground[i]; ++c) {
                values.push_back(float(light(space, areas_.rgb()[c])));
                photograph.push_back(view.photograph[c]);
            }
        return 1 / find_exposure(dataset_->encoding, values, photograph, 1 / around);
    }
    Gain best_gain(TargetSpace space, const JudgedView& view) const {
        if (!has_channel_gains_) return best_gain(space, view, 0, 2, view.gain[0]);
        std::array<double, 3> gains;
        for (size_t c = 0; c < 3; ++c) gains[c] = best_gain(space, view, c, c, view.gain[c]);
        return Gain(gains);
    }

    const Dataset* dataset_;
    bool has_gains_, has_channel_gains_;
    ImageStream stream_;
    PixelAreas areas_;
    TargetImage image_;
    std::vector<ErrorBar> bars_;
};

/// Those of all threads.
class Benches {
public:
    Benches(const Dataset& dataset, int pixel_points)
        : dataset_(&dataset),
          pixel_points_(pixel_points),
          as_stored_(without_gains(dataset)),
          stream_(as_stored_, StreamSource::disk),
          of_workers_(size_t(thread_count())) {}

    Bench& of(int worker) {
        auto& bench = of_workers_.at(size_t(worker));
        if (!bench) bench = std::make_unique<Bench>(*dataset_, stream_.another(), pixel_points_);
        return *bench;
    }
    const ImageStream& stream() const { return stream_; }

private:
    const Dataset* dataset_;
    int pixel_points_;
    Dataset as_stored_;
    ImageStream stream_;
    std::vector<std::unique_ptr<Bench>> of_workers_;
};

/// `parts`, if given, takes the errors of each part of the surface as well.
ImageFigures figures(const JudgedView& judged, const View& view, Encoding encoding, const SurfaceParts* surface,
                     const std::vector<RasterPixel>& seen, const NearestTraining* nearest,
                     std::vector<PartFigures>& parts) {
    ImageFigures f;
    f.name = view.name;
    f.gain = judged.gain;
    for (size_t i = 0; i < judged.missing.size(); ++i)
        for (size_t c = 3 * i; c < 3 * i + 3 && judged.missing[i]; ++c) f.missing.add(-double(judged.photograph[c]));
    for (size_t i = 0; i < judged.foreground.size(); ++i) {
        if (!judged.foreground[i]) continue;
        ++f.pixels;
        ErrorSums* const by_angle = nearest ? &f.by_angle.at(nearest->angle(view, seen[i])) : nullptr;
        for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const double render = judged.render[c], photograph = judged.photograph[c];
            f.stored.add(render - photograph);
            if (by_angle) by_angle->add(render - photograph);
            if (surface) parts[surface->of(seen[i])].stored.add(render - photograph);
            if (encoding == Encoding::u8_srgb) f.linear.add(srgb_decode(render) - light_of_byte(judged.photograph[c]));
        }
    }
    if (encoding != Encoding::u8_srgb) f.linear = f.stored;
    return f;
}

}  // namespace

std::string to_string(Split split) {
    return split == Split::train ? "train" : split == Split::test ? "test" : "validation";
}

JudgeResult judge(const Contestant& contestant, const Dataset& dataset, Split split, const JudgeOptions& options) {
    JudgeResult result;
    result.split = split;
    result.pixel_points = PixelAreas(dataset, options.pixel_points).points();
    const SurfaceParts* parts = options.parts && options.parts->of ? options.parts : nullptr;
    const std::vector<uint32_t> views = dataset.split(split != Split::train);
    if (views.empty())
        throw UserError(fmt::format(
            "{}: no view belongs to the {} split; {}", dataset.folder.string(), to_string(split),
            split == Split::test ? at_command_line("hold some out (import --holdout), or judge --split train",
                                                   "hold some out, or judge the train split")
                                 : at_command_line("judge --split test", "judge the test split")));
    Benches benches(dataset, options.pixel_points);
    std::optional<NearestTraining> nearest;
    if (options.by_angle && split != Split::train) nearest.emplace(dataset, benches.stream());
    result.images.resize(views.size());
    if (parts)
        for (const std::string& name : parts->names) result.parts.push_back({name, {}});
    std::vector<std::vector<PartFigures>> image_parts(views.size(), result.parts);
    parallel_for(views.size(), 1, [&](size_t i, int worker) {
        Bench& bench = benches.of(worker);
        const JudgedView judged = bench.compare(contestant, views[i], worker);
        result.images[i] = figures(judged, dataset.views[views[i]], dataset.encoding, parts, bench.seen(),
                                   nearest ? &*nearest : nullptr, image_parts[i]);
        if (options.ssim) result.images[i].ssim = ssim(judged);
        result.images[i].error_bars = bench.error_bars(contestant, dataset.views[views[i]], judged);
        if (options.judged) options.judged();
    });
    for (const auto& of_image : image_parts)
        for (size_t k = 0; k < of_image.size(); ++k) result.parts[k].stored.add(of_image[k].stored);
    const std::vector<double> angles = angles_outside(surface_centre(dataset.mesh, dataset.grid), dataset.views);
    for (size_t i = 0; i < views.size(); ++i) {
        ImageFigures& image = result.images[i];
        image.outside = angles[views[i]];
        if (contestant.share_of_fit) image.share_of_fit = contestant.share_of_fit(dataset.views[views[i]]);
        result.missing.add(image.missing);
        result.ssim.add(image.ssim);
        result.by_angle.add(image.by_angle);
        result.error_bars.add(image.error_bars);
        result.stored.add(image.stored);
        result.linear.add(image.linear);
        const bool outside = image.outside >= least_outside;
        (outside ? result.outside : result.inside).add(image.stored);
        result.outside_count += outside;
    }
    check_foreground(result.stored, dataset, split);
    return result;
}

ViewJudge::ViewJudge(const Dataset& dataset, int pixel_points)
    : compare_([&dataset, benches = std::make_shared<Benches>(dataset, pixel_points)](const Contestant& contestant,
                                                                                      uint32_t view, int worker) {
          if (view >= dataset.views.size())
              throw UserError(fmt::format("{}: there is no view {}; choose 0 to {}", dataset.folder.string(), view,
                                          dataset.views.size() - 1));
          return benches->of(worker).compare(contestant, view, worker);
      }) {}

void check_foreground(const ErrorSums& pooled, const Dataset& dataset, Split split) {
    if (pooled.values == 0)
        throw UserError(
            fmt::format("{}: no pixel of the {} views sees the mesh inside its mask; check that mesh, "
                        "cameras and masks belong together",
                        dataset.folder.string(), to_string(split)));
}

ErrorSums differences(std::span<const float> a, std::span<const float> b, std::span<const uint8_t> foreground) {
    ErrorSums sums;
    for (size_t i = 0; i < foreground.size(); ++i)
        for (size_t c = 3 * i; c < 3 * i + 3 && foreground[i]; ++c) sums.add(double(a[c]) - double(b[c]));
    return sums;
}

}  // namespace radiafit
