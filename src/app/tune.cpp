#include "app/tune.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "app/family.h"
#include "base/clock.h"
#include "eval/judge.h"

namespace radiafit {
namespace {

/// What is tried of an option, in order, besides where a search begins.
struct Ladder {
    const char* option;
    std::vector<const char*> values;
    bool (*means_something)(const FitRequest& request) = [](const FitRequest&) { return true; };
};

struct Candidate {
    std::vector<FitSetting> starts;
    std::vector<Ladder> ladders;
};

/// Robust losses, for solvers that take them, and where residuals begin to count less.
const Ladder losses = {"loss", {"square", "huber", "cauchy"}},
             loss_scales = {"loss_scale", {"0.02", "0.05", "0.1", "0.2"}, [](const FitRequest&request) {
                                return request.model.loss.robust();
                            }};

const std::vector<const char*> noises = {"1.5e-4", "3e-4", "6e-4", "1.2e-3", "2.4e-3"}, sides = {"8", "12", "16"};

/// Models of surfaces under light that stays, by what they are told apart by.
std::vector<Candidate> under_fixed_light() {
    return {
        {{{{"model", "viewbasis"}, {"rank", "10"}}, {{"model", "viewbasis"}, {"rank", "28"}}},
         {{"rank", {"4", "6", "10", "15", "20", "28"}},
          {"noise", noises},
          {"surface_side", sides},
          {"blocks", {"1", "100", "400", "1600"}}}},
        {{{{"model", "sg"}, {"lobes", "4"}}},
         {{"lobes", {"1", "2", "3", "4"}}, {"noise", noises}, {"surface_side", sides}}},
        {{{{"model", "lfm"}, {"terms", "3"}, {"lambda_surface", "1e-3"}, {"lambda_view", "0.1"}},
          {{"model", "lfm"}, {"terms", "3"}, {"lambda_surface", "1e-3"}, {"lambda_view", "0.1"}, {"loss", "huber"}}},
         {{"terms", {"1", "2", "3", "4", "6"}},
          {"lambda_surface", {"1e-4", "3e-4", "1e-3", "3e-3", "1e-2"}},
          {"lambda_view", {"0.01", "0.03", "0.1", "0.3", "1"}},
          losses,
          loss_scales}}};
}

std::vector<Candidate> under_lamps() {
    const std::vector<Ladder> ladders = {
        {"clip_above", {"0", "0.9", "0.98"}}, {"shadow_below", {"0", "0.05", "0.1", "0.2"}}, losses, loss_scales};
    std::vector<Candidate> out;
    for (const char* model : {"lafortune", "ptm", "lambert"})
        out.push_back({{{{"model", model}},
                        {{"model", model}, {"clip_above", "0.98"}, {"shadow_below", "0.1"}},
                        {{"model", model}, {"clip_above", "0.98"}, {"shadow_below", "0.1"}, {"loss", "huber"}}},
                       ladders});
    return out;
}

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

/// Whether two values of an option are one: numbers may be written in several ways.
bool same_value(const std::string& a, const std::string& b) {
    const auto number = [](const std::string& text) -> std::optional<double> {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        return end && *end == 0 ? std::optional(value) : std::nullopt;
    };
    const auto x = number(a), y = number(b);
    return a == b || (x && y && std::abs(*x - *y) < 1e-3 * std::abs(*y));
}

class Search {
public:
    Search(const Dataset& dataset, const TuneOptions& options, const std::function<void(const TriedSetting&)>& tried)
        : dataset_(dataset), judged_(for_validation(dataset, options.validation)), options_(options), tried_(tried) {}

    std::vector<TriedSetting> run(std::optional<Interrupted>* stopped) {
        try {
            search();
        } catch (const Interrupted& interrupted) {
            if (!stopped) throw;
            *stopped = interrupted;
        }
        std::ranges::stable_sort(all_, [](const auto& a, const auto& b) { return a.psnr > b.psnr; });
        return all_;
    }

private:
    void search() {
        const auto candidates = dataset_.views[0].light ? under_lamps() : under_fixed_light();
        for (const Candidate& candidate : candidates)
            for (const FitSetting& start : candidate.starts) attempt(start);
        while (climb(candidates)) {
        }
    }
    const TriedSetting& best() const { return *std::ranges::max_element(all_, {}, &TriedSetting::psnr); }

    FitRequest request_of(const FitSetting& setting) const {
        FitRequest request;
        for (const auto& [option, value] : setting) request.set(option, value);
        request.validation = options_.validation;
        const auto given = [&](const char* flag) {
            return std::ranges::any_of(setting, [&](const auto& o) { return find_fit_option(o.first).flag == flag; });
        };
        family_of(request).settle(given, dataset_, request);
        return request;
    }

    /// Nothing where it was tried before, or no time is left for it.
    void attempt(const FitSetting& setting) {
        const std::string name = command_line_of(setting);
        if (std::ranges::find(names_, name) != names_.end()) return;
        double& expected = seconds_[setting.front().second];
        if (!all_.empty() && clock_.wall_s() + expected > options_.seconds) return;
        names_.push_back(name);
        const Stopwatch clock;
        const FitRequest request = request_of(setting);
        const FinishedFit done = family_of(request).fit(dataset_, request);
        const double fitting = clock.wall_s();
        const JudgeResult judged = judge(done.fit->contestant(), judged_, Split::validation);
        expected = clock.wall_s();
        if (!std::isfinite(judged.psnr())) return;
        all_.push_back({setting, judged.psnr(), judged.ape(), fitting});
        if (tried_) tried_(all_.back());
    }

    /// Tries what stands beside the best setting, option by option; whether that led to a better one.
    bool climb(const std::vector<Candidate>& candidates) {
        const TriedSetting before = best();
        const std::string& model = before.setting.front().second;
        for (const Candidate& candidate : candidates) {
            if (candidate.starts.front().front().second != model) continue;
            for (const Ladder& ladder : candidate.ladders) {
                const FitSetting from = best().setting;
                const FitRequest request = request_of(from);
                if (!ladder.means_something(request)) continue;
                const std::string now = value_of(from, ladder.option, request.text(ladder.option));
                const auto at = std::ranges::find_if(ladder.values, [&](const char* v) { return same_value(v, now); });
                if (at == ladder.values.end()) continue;
                if (at != ladder.values.begin()) attempt(with(from, ladder.option, at[-1]));
                if (at + 1 != ladder.values.end()) attempt(with(from, ladder.option, at[1]));
            }
        }
        return best().psnr > before.psnr + 0.02;
    }

    const Dataset& dataset_;
    const Dataset judged_;
    TuneOptions options_;
    const std::function<void(const TriedSetting&)>& tried_;
    Stopwatch clock_;
    std::vector<TriedSetting> all_;
    std::vector<std::string> names_;         ///< of all that was tried
    std::map<std::string, double> seconds_;  ///< that a model's last attempt took
};

}  // namespace

int left_out_every(const Dataset& dataset, const TuneOptions& options) {
    return std::max(2, std::min(options.validation, int(dataset.split(false).size() / 2)));
}

std::vector<TriedSetting> tune(const Dataset& dataset, const TuneOptions& options,
                               const std::function<void(const TriedSetting&)>& tried,
                               std::optional<Interrupted>* stopped) {
    require("seconds", options.seconds, limits::tune_seconds);
    require("validation", options.validation, limits::tune_validation);
    return Search(dataset, {options.seconds, left_out_every(dataset, options)}, tried).run(stopped);
}

}  // namespace radiafit
