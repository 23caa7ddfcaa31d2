#include <algorithm>
#include <optional>

#include "base/clock.h"
#include "base/error.h"
#include "cpu/surface_prior.h"
#include "fitting/parts/texel_parts.h"
#include "fitting/plan/plan_rows.h"

namespace radiafit::fits {
namespace {

constexpr size_t floats_per_sample = 4;  // r, g, b, and the dataset's view

/// What a part keeps of its poorly seen texels: how many samples of each unit, then the samples.
std::vector<float> kept(const TexelSamples& samples, std::span<const size_t> texels, std::span<const uint32_t> views) {
    std::vector<float> out;
    for (const size_t t : texels) out.push_back(float(samples.of(t).size()));
    for (const size_t t : texels)
        for (const TexelRadiance& s : samples.of(t))
            out.insert(out.end(), {s.value[0], s.value[1], s.value[2], float(views[s.image])});
    return out;
}

/// The same read back, of some of the part's units.
class KeptSamples final : public TexelSource {
public:
    /// The part must outlive it. units: ascending, some of the part's. images: by the dataset's view, its position
    /// among those that are fitted. Throws UserError, prefixed by `name`, for a part that keeps something else.
    KeptSamples(const PartResult& part, const std::string& name, const std::vector<uint32_t>& units,
                const std::vector<std::optional<uint32_t>>& images)
        : values_(part.own), images_(images) {
        const size_t count = part.units.size();
        const auto require = [&](bool right) {
            if (!right) throw_foreign(name);
        };
        require(values_.size() >= count);
        uint64_t sum = 0;
        for (size_t i = 0; i < count; ++i) {
            const float own = values_[i];
            require(own >= 0 && own <= float(values_.size()));
            if (ranges_.size() < units.size() && part.units[i] == units[ranges_.size()])
                ranges_.push_back({sum, sum + uint64_t(own)});
            sum += uint64_t(own);
        }
        require(values_.size() == count + floats_per_sample * sum);
        values_ = values_.subspan(count);
        for (size_t i = floats_per_sample - 1; i < values_.size(); i += floats_per_sample)
            require(values_[i] >= 0 && values_[i] < float(images_.size()) && images_[size_t(values_[i])]);
    }
    uint32_t texel_count() const override { return uint32_t(ranges_.size()); }
    uint64_t sample_count() const override { return values_.size() / floats_per_sample; }
    void read(uint32_t begin, TexelSamples& out) const override {
        out.first.assign(1, 0);
        out.samples.clear();
        for (const auto& [first, end] : std::span(ranges_).subspan(begin, std::min(block, texel_count() - begin))) {
            for (const float* v = &values_[floats_per_sample * first]; v < &values_[0] + floats_per_sample * end;
                 v += floats_per_sample)
                out.samples.push_back({{v[0], v[1], v[2]}, *images_[size_t(v[3])]});
            out.first.push_back(out.samples.size());
        }
    }

private:
    struct Range {
        uint64_t first, end;  ///< of samples
    };
    std::span<const float> values_;
    std::span<const std::optional<uint32_t>> images_;
    std::vector<Range> ranges_;
};

void exchange(ReflectanceFit& fit, TexelResult& result) {
    fit.parameters.swap(result.parameters);
    fit.status.swap(result.status);
    fit.iterations.swap(result.iterations);
    fit.samples.swap(result.samples);
    fit.error.swap(result.error);
}

/// The surface's prior is learned when all parts have been fitted, without it; parts keep the samples of texels that it
/// changes.
class DividedReflectance final : public DividedTexels {
public:
    DividedReflectance(const Dataset& dataset, const FitRequest& request)
        : DividedTexels(dataset, request, texel_atlas(dataset, request.model.surface_side),
                        size_t(request.texel_model()->parameters)) {}

    PartResult solve(const Part& part) const override {
        const ReflectanceOutcome outcome = solve_reflectance(part.dataset, part.request);
        PartResult out =
            result_of(part, outcome.fit, outcome.fit.parameters, run_to_json(outcome, {}, outcome.samples));
        if (!request_.has_prior()) return out;
        std::vector<size_t> texels;
        for (size_t i = 0; i < part.units.size(); ++i) texels.push_back(texel_in(part, i));
        out.own = kept(outcome.poorly_seen, texels, fitted_views(part.dataset, part.request));
        return out;
    }
    uint64_t merge_bytes(size_t parts) const override {
        if (!request_.has_prior()) return DividedTexels::merge_bytes(parts);
        return DividedTexels::merge_bytes(parts) + prior_row(*request_.texel_model(), atlas_->texel_count()).bytes +
               samples_about() * floats_per_sample * sizeof(float) / parts;
    }

    FinishedFit finish(const EachPart& each_part) override {
        ReflectanceOutcome out;
        put_together(out.fit, out.fit.parameters);
        static_cast<FitRun&>(out) = run_.run();
        out.samples = run_.samples();
        out.fit.options = request_.texel_options();
        if (request_.has_prior()) look_around(each_part, out);
        out.atlas = std::move(atlas_);
        return finished_reflectance(std::move(out), *dataset_);
    }

private:
    uint64_t samples_about() const {
        if (!samples_about_)
            samples_about_ = estimate_samples(*dataset_, *atlas_, request_, views_to_count_samples_on).samples;
        return *samples_about_;
    }
    /// Learns the prior from the fit, and fits poorly seen texels with it, part by part.
    void look_around(const EachPart& each_part, ReflectanceOutcome& out) const {
        const Stopwatch clock;
        ReflectanceFit& fit = out.fit;
        const TexelModel& model = *fit.options.model;
        TexelResult all;
        exchange(fit, all);
        std::vector<std::optional<uint32_t>> images(dataset_->views.size());
        for (uint32_t i = 0; i < views_.size(); ++i) images[views_[i]] = i;
        const TexelLoader loader(*dataset_, *atlas_, views_, fit.options);
        if (const auto prior = learn_surface_prior(model, *atlas_, all))
            each_part([&](const PartResult& part, const std::string& name) {
                std::vector<uint32_t> texels;
                for (const uint32_t t : part.units)
                    if (poorly_seen(model, all.status[t], all.samples[t])) texels.push_back(t);
                const KeptSamples samples(part, name, texels, images);
                fit_with_prior(*prior, {samples, loader, fit.options}, texels, {.iterations = request_.iterations},
                               all);
            });
        exchange(fit, all);
        out.sample_iterations += all.sample_iterations;
        out.times.streaming += all.load_s;
        out.times.optimization += clock.wall_s() - all.load_s;
        out.times.total += clock.wall_s();
    }

    mutable std::optional<uint64_t> samples_about_;
};

}  // namespace

std::unique_ptr<Divided> divide_texels(const Dataset& dataset, const FitRequest& asked) {
    asked.check();
    require_lights(dataset);
    FitRequest request = asked;
    request.space = TargetSpace::linear;  // the only one that reflectance has
    return std::make_unique<DividedReflectance>(dataset, request);
}

}  // namespace radiafit::fits
