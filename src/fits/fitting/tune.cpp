#include "fitting/tune.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "base/clock.h"
#include "base/error.h"
#include "base/rng.h"
#include "eval/judge.h"
#include "fitting/family.h"
#include "fitting/off_photographs.h"
#include "fitting/resolve_options.h"

namespace radiafit::fits {
namespace {

const std::string& value_of(const FitSetting& setting, const std::string& option, const std::string& otherwise) {
    for (const auto& [name, value] : setting)
        if (name == option) return value;
    return otherwise;
}

FitSetting with(FitSetting setting, const std::string& option, const std::string& value) {
    for (auto& [name, old] : setting)
        if (name == option) return old = value, setting;
    setting.emplace_back(option, value);
    return setting;
}

std::optional<double> number_in(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    return end != text.c_str() && *end == 0 ? std::optional(value) : std::nullopt;
}

/// Whether two values of an option are one: numbers may be written in several ways.
bool same_value(const std::string& a, const std::string& b) {
    const auto x = number_in(a), y = number_in(b);
    return a == b || (x && y && std::abs(*x - *y) < 1e-3 * std::abs(*y));
}

class Search {
public:
    Search(const Dataset& dataset, const TuneOptions& options, const std::function<void(const TriedSetting&)>& tried)
        : dataset_(dataset), judged_(for_validation(dataset, options.validation)), options_(options), tried_(tried) {}

    Tuned run(std::optional<Interrupted>* stopped) {
        try {
            search();
            weigh_off_photographs();
        } catch (const Interrupted& interrupted) {
            if (!stopped) throw;
            *stopped = interrupted;
        }
        std::ranges::stable_sort(all_, [](const auto& a, const auto& b) { return a.psnr > b.psnr; });
        std::erase_if(left_out_, [&](const UntriedSetting& s) { return was_tried(command_line_of(s.setting)); });
        const size_t recommended = recommended_of(all_);
        return {std::move(all_), recommended, std::move(left_out_), std::move(models_left_out_), off_left_out_};
    }

private:
    void search() {
        std::vector<TuneCandidate> all;
        for (const Family* family : families())
            for (TuneCandidate& candidate : family->candidates(dataset_)) all.push_back(std::move(candidate));
        const std::vector<TuneCandidate> candidates = with_fixed(all);
        for (const TuneCandidate& candidate : candidates)
            for (const FitSetting& start : candidate.starts) attempt(start);
        while (climb(candidates)) {
        }
    }

    bool is_fixed(const std::string& option) const {
        return std::ranges::any_of(options_.fixed, [&](const auto& o) { return o.first == option; });
    }

    /// Whether a fit takes all fixed options: each means something to it, and none excludes what the setting has.
    bool is_possible(const FitSetting& setting) const {
        try {
            return takes_given(given_by(options_.fixed), request_of(setting));
        } catch (const UserError&) {
            return false;
        }
    }

    /// The candidates that take all fixed options, with these in place of what they would try of them.
    std::vector<TuneCandidate> with_fixed(const std::vector<TuneCandidate>& candidates) {
        std::vector<TuneCandidate> out;
        for (TuneCandidate candidate : candidates) {
            const std::string model = candidate.starts.front().front().second;
            for (FitSetting& start : candidate.starts)
                for (const auto& [option, value] : options_.fixed) start = with(std::move(start), option, value);
            std::erase_if(candidate.starts, [&](const FitSetting& start) {
                return start.front().second != model || !is_possible(start);
            });
            if (candidate.starts.empty()) {
                models_left_out_.push_back(model);
                continue;
            }
            std::erase_if(candidate.ladders, [&](const Ladder& ladder) { return is_fixed(ladder.option); });
            out.push_back(std::move(candidate));
        }
        if (out.empty())
            throw UserError(fmt::format("tune: no model that suits {} takes all of {}; leave some of them out",
                                        dataset_.folder.string(), command_line_of(options_.fixed)));
        return out;
    }

    const TriedSetting& best() const { return *std::ranges::max_element(all_, {}, &TriedSetting::psnr); }

    FitRequest request_of(const FitSetting& setting) const {
        FitRequest request = resolved_request(setting, dataset_);
        request.validation = options_.validation;
        return request;
    }

    bool was_tried(const std::string& name) const { return std::ranges::find(names_, name) != names_.end(); }

    /// Fits and judges a setting, unless it was tried before or no time is left for it.
    void attempt(const FitSetting& setting) {
        const std::string name = command_line_of(setting);
        if (was_tried(name)) return;
        double& expected = seconds_[setting.front().second];
        const double kept = expected > 0 ? reserved() : 0;  // a model's first fit comes before
        if (!all_.empty() && clock_.wall_s() + expected + kept > options_.seconds) {
            const auto same = [&](const UntriedSetting& s) { return command_line_of(s.setting) == name; };
            if (std::ranges::none_of(left_out_, same)) left_out_.push_back({setting, expected});
            return;
        }
        names_.push_back(name);
        const Stopwatch clock;
        const FitRequest request = request_of(setting);
        FinishedFit done = family_of(request).fit(dataset_, request);
        const double fitting = clock.wall_s();
        const JudgeResult judged = judge(contestant_of(done.fit), judged_, Split::validation);
        expected = clock.wall_s();
        if (!std::isfinite(judged.psnr())) return;
        all_.push_back({.setting = setting,
                        .psnr = judged.psnr(),
                        .ape = judged.ape(),
                        .seconds = fitting,
                        .judge_seconds = expected - fitting,
                        .numbers = number_count(done.fit),
                        .errors = {}});
        for (const ImageFigures& image : judged.images) all_.back().errors.push_back(image.stored);
        if (tried_) tried_(all_.back());
    }

    /// Seconds that are kept for weigh_off_photographs().
    double reserved() const {
        double sum = 0;
        int models = 0;
        for (const auto& [model, seconds] : seconds_) sum += seconds, models += seconds > 0;
        return dataset_.light_moves() || models < 2 ? 0 : std::min(sum, options_.seconds / 3);
    }

    /// Fits the best setting of each model that is near the best one, without the views around some, and judges it
    /// there.
    void weigh_off_photographs() {
        constexpr double near = 1;  // dB
        std::map<std::string, TriedSetting*> of_model;
        for (TriedSetting& t : all_) {
            TriedSetting*& held = of_model[t.setting.front().second];
            if (!held || t.psnr > held->psnr) held = &t;
        }
        std::erase_if(of_model, [&](const auto& entry) { return entry.second->psnr < best().psnr - near; });
        if (dataset_.light_moves() || of_model.size() < 2) return;
        double expected = 0;
        for (const auto& [model, held] : of_model) expected += held->seconds + held->judge_seconds;
        if (clock_.wall_s() + expected > options_.seconds) {
            off_left_out_ = expected;
            return;
        }
        const FarViews far = far_views(dataset_, dataset_.split(false), off_photographs_degrees);
        if (far.judged.empty()) return;
        const Dataset split = split_by(dataset_, far);
        std::map<TriedSetting*, double> weighed;
        for (const auto& [model, held] : of_model) {
            FitRequest request = request_of(held->setting);
            request.validation = 0;
            try {
                FinishedFit done = family_of(request).fit(split, request);
                weighed[held] = judge(contestant_of(done.fit), split, Split::test).psnr();
            } catch (const UserError&) {
                return;  // of views that are too few for a model
            }
        }
        if (std::ranges::all_of(weighed, [](const auto& entry) { return std::isfinite(entry.second); }))
            for (const auto& [held, psnr] : weighed) held->off_psnr = psnr;
    }

    /// Tries the values next to the best setting's, option by option; whether that led to a better one.
    bool climb(const std::vector<TuneCandidate>& candidates) {
        const TriedSetting before = best();
        const std::string& model = before.setting.front().second;
        for (const TuneCandidate& candidate : candidates) {
            if (candidate.starts.front().front().second != model) continue;
            for (const Ladder& ladder : candidate.ladders) {
                const FitSetting from = best().setting;
                const FitRequest request = request_of(from);
                if (!ladder.means_something(request)) continue;
                const std::string now = value_of(from, ladder.option, request.text(ladder.option));
                const auto at = std::ranges::find_if(ladder.values, [&](const char* v) { return same_value(v, now); });
                const bool on_it = at != ladder.values.end();
                if (!on_it && !number_in(now)) continue;
                // The neighbours of a number that is not on the ladder are the next ones.
                const auto above = [&](const char* v) { return number_in(v) > number_in(now); };
                const auto higher = on_it ? at + 1 : std::ranges::find_if(ladder.values, above);
                const auto end_of_lower = on_it ? at : higher;
                if (end_of_lower != ladder.values.begin()) attempt(with(from, ladder.option, end_of_lower[-1]));
                if (higher != ladder.values.end()) attempt(with(from, ladder.option, *higher));
            }
        }
        return best().psnr > before.psnr + 0.02;
    }

    const Dataset& dataset_;
    const Dataset judged_;
    const TuneOptions options_;
    const std::function<void(const TriedSetting&)>& tried_;
    Stopwatch clock_;
    std::vector<TriedSetting> all_;
    std::vector<std::string> names_;  ///< of all that was tried
    std::vector<UntriedSetting> left_out_;
    std::vector<std::string> models_left_out_;
    std::optional<double> off_left_out_;
    std::map<std::string, double> seconds_;  ///< that a model's last attempt took
};

}  // namespace

int left_out_every(const Dataset& dataset, const TuneOptions& options) {
    return std::max(2, std::min(options.validation, int(dataset.split(false).size() / 2)));
}

size_t smallest_as_good(const std::vector<TriedSetting>& best_first) {
    constexpr int draws = 2000;
    constexpr double certain = 0.975;
    constexpr double least_of_twice = 0.05;  // dB that twice the numbers must bring
    const auto gain = [](const TriedSetting& a, const TriedSetting& b) {
        double of_a = 0, of_b = 0;
        for (const ErrorSums& e : a.errors) of_a += e.squared;
        for (const ErrorSums& e : b.errors) of_b += e.squared;
        return 10 * std::log10(of_b / of_a);
    };
    const auto beats = [&](const TriedSetting& a, const TriedSetting& b) {
        Rng rng(1);  // the same draws for all
        const auto views = uint32_t(a.errors.size());
        int lower = 0;
        for (int d = 0; d < draws; ++d) {
            double difference = 0;
            for (uint32_t i = 0; i < views; ++i) {
                const uint32_t v = rng.index(views);
                difference += a.errors[v].squared - b.errors[v].squared;  // of the same pixels
            }
            lower += difference < 0;
        }
        return lower >= certain * draws;
    };
    const TriedSetting& best = best_first[0];
    const auto as_good = [&](const TriedSetting& other) {
        const double doublings = std::log2(double(best.numbers) / double(other.numbers));
        return gain(best, other) < least_of_twice * doublings || !beats(best, other);
    };
    size_t out = 0;
    for (size_t i = 1; i < best_first.size(); ++i)
        if (best_first[i].numbers < best_first[out].numbers && as_good(best_first[i])) out = i;
    return out;
}

size_t recommended_of(const std::vector<TriedSetting>& best_first) {
    const TriedSetting* best = nullptr;
    int weighed = 0;
    const auto mean = [](const TriedSetting& t) { return (t.psnr + *t.off_psnr) / 2; };
    for (const TriedSetting& t : best_first) {
        if (!t.off_psnr) continue;
        ++weighed;
        if (!best || mean(t) > mean(*best)) best = &t;
    }
    if (weighed < 2) return smallest_as_good(best_first);
    std::vector<TriedSetting> of_model;
    std::vector<size_t> places;
    for (size_t i = 0; i < best_first.size(); ++i)
        if (best_first[i].setting.front() == best->setting.front()) {
            of_model.push_back(best_first[i]);
            places.push_back(i);
        }
    return places[smallest_as_good(of_model)];
}

Tuned tune(const Dataset& dataset, const TuneOptions& options, const std::function<void(const TriedSetting&)>& tried,
           std::optional<Interrupted>* stopped) {
    require("seconds", options.seconds, limits::tune_seconds);
    require("validation", options.validation, limits::tune_validation);
    return Search(dataset, {options.seconds, left_out_every(dataset, options), options.fixed}, tried).run(stopped);
}

}  // namespace radiafit::fits
