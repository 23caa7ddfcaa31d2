#include "bench/rows.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/statistics.h"
#include "bench/columns.h"
#include "report/csv_file.h"
#include "report/half_rows.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::bench;

void write_scenes(const BenchResults& results, const ResultFolder& folder) {
    CsvFile rows(folder.path(), rows::scenes);
    for (const auto& [name, facts] : results.scenes)
        rows.add({name, facts.images, facts.samples, facts.sites, facts.parameters});
    rows.commit();
}

void write_agreement(const BenchResults& results, const ResultFolder& folder) {
    CsvFile rows(folder.path(), rows::agreement);
    for (const Checked& c : results.checked) {
        const auto row = [&](const std::string& quantity, double difference, double tolerance) {
            rows.add({c.scene, name_of(c.device), quantity, difference, tolerance, difference <= tolerance});
        };
        if (!c.failure.empty()) {
            rows.add({c.scene, name_of(c.device), "run", {}, {}, false});
            continue;
        }
        row("samples", c.sums.other_share(), Agreement::most_other_samples);
        for (size_t q = 0; q < quantity_names.size(); ++q)
            row(quantity_names[q], c.sums.worst[q], Agreement::tolerance);
        row("fit", c.fit_difference, c.fit_tolerance);
    }
    rows.commit();
}

void write_repetitions(const BenchResults& results, const ResultFolder& folder) {
    CsvFile rows(folder.path(), rows::measurements);
    for (const Timed& t : results.timed)
        for (const auto& [pass, series] : t.series)
            for (size_t r = 0; r < series.seconds.size(); ++r)
                rows.add({t.scene, name_of(t.device), name_of(pass), r, series.seconds[r], series.streaming_s[r]});
    rows.commit();
}

void write_peaks(const BenchResults& results, const ResultFolder& folder) {
    CsvFile rows(folder.path(), rows::peaks);
    for (size_t r = 0; r < results.peaks.size(); ++r)
        for (const auto& [device, peaks] : results.peaks[r])
            for (const auto& [name, rate] :
                 {std::pair{"operations", peaks.operations}, {"reads", peaks.reads}, {"bytes", peaks.bytes}})
                if (rate > 0) rows.add({name_of(device), name, r, rate});
    rows.commit();
}

void write_groups(const BenchResults& results, const ResultFolder& folder) {
    CsvFile rows(folder.path(), rows::groups);
    for (const Timed& t : results.timed) {
        const size_t chosen = t.contestant->group_size();
        if (chosen == 0) continue;
        std::vector<TriedGroup> tried = t.contestant->tried_groups();
        for (const auto& [invocations, seconds] : tried)
            rows.add({t.scene, name_of(t.device), invocations, seconds, invocations == chosen});
        if (std::ranges::find(tried, chosen, &TriedGroup::invocations) == tried.end())
            rows.add({t.scene, name_of(t.device), chosen, {}, true});
    }
    rows.commit();
}

void write_halves(const BenchResults& results, const ResultFolder& folder) {
    CsvFile rows(folder.path(), rows_of::halves);
    for (const HalfRounding& h : results.halves) rows.add({h.of, h.values, h.subnormals});
    rows.commit();
}

/// The rate of a pass as a share of the peak of the same round; median over the rounds.
std::optional<double> share(const std::optional<double>& amount, const std::vector<double>& seconds, Device device,
                            double DevicePeaks::*rate, const std::vector<Peaks>& peaks) {
    if (!amount) return std::nullopt;
    std::vector<double> shares;
    for (size_t r = 0; r < seconds.size(); ++r) shares.push_back(*amount / seconds[r] / (peaks[r].at(device).*rate));
    return median(shares);
}

/// What a pass of a device comes to.
struct Summary {
    double seconds = 0, ms_per_image = 0, ns_per_sample = 0;
    std::optional<Interval> interval = {};
    PassLoad load = {}, shares = {};
};

Summary summary_of(const BenchResults& results, const Timed& t, Pass pass) {
    const auto scene = std::ranges::find(results.scenes, t.scene, &std::pair<std::string, SceneFacts>::first);
    const SceneFacts& facts = scene->second;
    const std::vector<double>& seconds = t.series.at(pass).seconds;
    Summary s{.seconds = median(seconds)};
    s.ms_per_image = 1e3 * s.seconds / double(facts.images);
    s.ns_per_sample = 1e9 * s.seconds / double(facts.site_samples);
    s.interval = median_interval(seconds, seconds.size());
    s.load = t.contestant->load(pass);
    s.shares.operations = share(s.load.operations, seconds, t.device, &DevicePeaks::operations, results.peaks);
    s.shares.reads = share(s.load.reads, seconds, t.device, &DevicePeaks::reads, results.peaks);
    s.shares.bytes = share(s.load.bytes, seconds, t.device, &DevicePeaks::bytes, results.peaks);
    return s;
}

void write_summary(const BenchResults& results, const ResultFolder& folder) {
    CsvFile rows(folder.path(), rows::summary);
    for (const Timed& t : results.timed)
        for (const auto& [pass, series] : t.series) {
            const Summary s = summary_of(results, t, pass);
            const auto [low, high] = ends_of(s.interval);
            rows.add({t.scene, name_of(t.device), name_of(pass), s.seconds, low, high, s.ms_per_image, s.ns_per_sample,
                      s.load.operations, s.load.reads, s.load.bytes, s.shares.operations, s.shares.reads,
                      s.shares.bytes, series.seconds.size(),
                      needs_opengl(t.device) ? results.renderer : results.processor});
        }
    rows.commit();
}

}  // namespace

std::string Checked::disagreement() const {
    if (!failure.empty()) return failure;
    std::string text = sums.disagreement();
    if (!(fit_difference <= fit_tolerance))
        text += fmt::format("{}errors of {} iterations off by {:.1e}", text.empty() ? "" : ", ",
                            BenchScene::fit_iterations, fit_difference);
    return text;
}

void write_rows(const BenchResults& results, const ResultFolder& folder) {
    write_scenes(results, folder);
    write_agreement(results, folder);
    write_repetitions(results, folder);
    write_peaks(results, folder);
    write_groups(results, folder);
    write_halves(results, folder);
    write_summary(results, folder);
}

std::string agreement_table(const std::vector<Checked>& checked) {
    Table table({"problem", "device", "sums, of their terms", "other samples", "fit", "verdict"});
    for (const Checked& c : checked) {
        if (!c.failure.empty()) {
            table.add({c.scene, name_of(c.device), "", "", "", "DOES NOT RUN"});
            continue;
        }
        const double worst = *std::ranges::max_element(c.sums.worst);
        table.add({c.scene, name_of(c.device), fmt::format("{:.1e}", worst), fmt::format("{}", c.sums.other_samples),
                   fmt::format("{:.1e}", c.fit_difference),
                   !c.disagreement().empty() ? "DISAGREES"
                   : c.sums.takes_others()   ? "agrees, OTHER SAMPLES"
                                             : "agrees"});
    }
    return table.text();
}

std::string time_table(const BenchResults& results) {
    Table table({"problem", "device", "pass", "ms per image", "95 %", "ns per sample", "of peak operations",
                 "of peak bytes", "of peak reads"});
    const auto percent = [](const std::optional<double>& x) { return x ? fmt::format("{:.1f} %", 100 * *x) : ""; };
    for (const Timed& t : results.timed)
        for (const auto& [pass, series] : t.series) {
            const Summary s = summary_of(results, t, pass);
            const double scale = s.ms_per_image / s.seconds;
            const std::string interval =
                s.interval ? fmt::format("{:.4g} to {:.4g}", scale * s.interval->low, scale * s.interval->high) : "";
            table.add({t.scene, name_of(t.device), name_of(pass), fmt::format("{:.4g}", s.ms_per_image), interval,
                       fmt::format("{:.4g}", s.ns_per_sample), percent(s.shares.operations), percent(s.shares.bytes),
                       percent(s.shares.reads)});
        }
    return table.text();
}

}  // namespace radiafit::harness
