#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "base/error.h"
#include "claim_rules.h"
#include "experiment.h"
#include "gl/context.h"

namespace radiafit {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

FinishedRun::FinishedRun(fs::path folder, const fs::path& results)
    : folder_(std::move(folder)), name_(fs::relative(folder_, results).generic_string()) {
    std::ifstream file(folder_ / "run.json");
    json_ = Json::parse(file, nullptr, false);
    if (!json_.is_object())
        throw UserError(fmt::format("{}: no JSON object; delete the run", (folder_ / "run.json").string()));
}

std::string FinishedRun::device() const {
    if (json_.contains("gl")) return json_.at("gl").at("renderer").get<std::string>();
    return fmt::format("{}, {} threads", cpu(), threads());
}

double FinishedRun::setting(const char* key) const {
    const Json config = json_.value("config", Json::object());
    if (!config.contains(key) || !config.at(key).is_number())
        throw UserError(fmt::format("{}: config.{} is missing; run the experiment again", name(), key));
    return config.at(key).get<double>();
}

std::string FinishedRun::text(const char* key) const {
    const Json config = json_.value("config", Json::object());
    return config.contains(key) && config.at(key).is_string() ? config.at(key).get<std::string>() : "";
}

namespace {

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

void demand_star_and_bust(Judgement& j, const CsvTable& t) {
    const auto has = [&](const char* name) {
        for (size_t i = 0; i < t.row_count(); ++i)
            if (t.text(i, "dataset") == name) return true;
        return false;
    };
    j.demand(has("star") && has("bust"), "star and bust");
}

// Figure 7.

Judgement iteration_ratio(const FinishedRun& run) {
    const CsvTable t = run.table("summary.csv");
    Judgement j;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const std::string& name = t.text(i, "dataset");
        const auto number = [&](const char* column) {
            j.values[name][column] = t.number(i, column);
            return t.number(i, column);
        };
        const double median = number("ratio_median"), low = number("ratio_quartile1"), high = number("ratio_quartile3");
        j.measure(median >= 5, fmt::format("{} {:.1f} times", name, median));
        j.why.push_back(fmt::format("{}: quartiles {:.1f} and {:.1f}, SD censored {}, CG unfinished {}", name, low,
                                    high, percent(number("sd_censored_share")),
                                    percent(number("cg_unfinished_share"))));
    }
    j.demand(run.setting("cap") >= 3000, fmt::format("caps of 3000 iterations, not {:g}", run.setting("cap")));
    j.demand(run.setting("lambda") == 1e-4 && run.setting("tolerance") == 1.01, "lambda = 1e-4 and 1.01 E_best");
    demand_star_and_bust(j, t);
    return j;
}

Judgement better_minimum(const FinishedRun& run) {
    const CsvTable t = run.table("summary.csv");
    Judgement j;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const double share = t.number(i, "cg_better_at_tenth_share");
        j.measure(share > 0.5, fmt::format("{} {}", t.text(i, "dataset"), percent(share)));
        j.values[t.text(i, "dataset")] = share;
    }
    const double cap = run.setting("cap");
    j.why = {fmt::format("share of problems where CG after {:g} iterations is below SD after {:g}", cap / 10, cap)};
    demand_star_and_bust(j, t);
    return j;
}

// Figure 8.

constexpr const char* paper_passes = "OpenGL (paper passes)";
constexpr const char* combined_passes = "OpenGL (combined passes)";
constexpr const char* optimizers[] = {"cg", "sd"};

/// The figure's bars.
class Bars {
public:
    explicit Bars(const FinishedRun& run) : rows(run.table("times.csv")) {}
    size_t row(const std::string& method, const std::string& optimizer) const {
        for (size_t i = 0; i < rows.row_count(); ++i)
            if (rows.text(i, "part") == "figure" && rows.text(i, "method") == method &&
                rows.text(i, "optimizer") == optimizer)
                return i;
        throw UserError(fmt::format("times.csv: no bar {}, {}; run fig8_time again", method, optimizer));
    }
    double total(const std::string& method, const std::string& optimizer) const {
        return rows.number(row(method, optimizer), "total_s");
    }
    /// Of its total.
    double share(const char* part, const std::string& method, const std::string& optimizer) const {
        return rows.number(row(method, optimizer), part) / total(method, optimizer);
    }
    std::string renderer() const { return rows.text(row(paper_passes, "cg"), "renderer"); }

    const CsvTable rows;
};

Judgement faster_than_cpu(const FinishedRun& run) {
    const Bars bars(run);
    Judgement j{.what = "CPU time over OpenGL's: ", .renderer = bars.renderer()};
    j.why = {fmt::format("{:g} iterations on {} CPU threads", run.setting("iterations"), run.threads())};
    for (const std::string optimizer : optimizers) {
        const double cpu = std::min(bars.total("two-step (compact record)", optimizer),
                                    bars.total("two-step (full record)", optimizer));
        const double gl = bars.total(paper_passes, optimizer), combined = bars.total(combined_passes, optimizer);
        j.measure(cpu / gl > 5, fmt::format("{} {:.3g}", optimizer, cpu / gl));
        j.values[optimizer] = {{"cpu_over_opengl", cpu / gl}, {"cpu_over_combined", cpu / combined}};
        j.why.push_back(
            fmt::format("{}: CPU {:.2f} s, OpenGL {:.2f} s, combined passes {:.2f} s", optimizer, cpu, gl, combined));
    }
    j.demand(!is_software_renderer(j.renderer), "a GPU, and this renderer is the CPU itself");
    j.demand(run.setting("iterations") == 100, "100 iterations");
    j.demand(run.text("dataset") == "star", "the star");
    return j;
}

Judgement distribution_share(const FinishedRun& run) {
    const CsvTable t = run.table("times.csv");
    Judgement j;
    double best = 0;
    for (size_t i = 0; i < t.row_count(); ++i) {
        if (t.text(i, "method") != "two-step (full record)") continue;
        const double share = t.number(i, "distribution_s") / t.number(i, "total_s");
        const std::string &optimizer = t.text(i, "optimizer"), &iterations = t.text(i, "iterations");
        best = std::max(best, share);
        j.measures.push_back(fmt::format("{} {} iterations {}", optimizer, iterations, percent(share)));
        j.values[fmt::format("{}_{}", optimizer, iterations)] = share;
        j.renderer = t.text(i, "renderer");
    }
    j.require(best >= 0.2);
    j.why = {
        "distribution's share of the two-step baseline's time with the paper's record; the rest is its optimization"};
    return j;
}

Judgement streaming_share(const FinishedRun& run) {
    const Bars bars(run);
    Judgement j{.renderer = bars.renderer()};
    bool cold = true;
    double cached = 0;
    for (const std::string optimizer : optimizers) {
        const size_t i = bars.row(paper_passes, optimizer);
        const double share = bars.share("streaming_s", paper_passes, optimizer);
        j.measure(share >= 0.1 && share <= 0.3, fmt::format("{} {}", optimizer, percent(share)));
        j.values[optimizer] = share;
        cached = std::max(cached, bars.rows.number(i, "cached_share"));
        cold = cold && bars.rows.text(i, "source") == "disk-cold" && cached <= 0.01;
    }
    j.values["cached_share"] = cached;
    if (cold) {
        j.why = {fmt::format("images from disk, {} of their pages in the page cache", percent(cached))};
    } else {
        j.verdict = "not run";
        j.why = {
            fmt::format("the images did not come from a cold disk: {} of their pages were cached", percent(cached))};
    }
    if (is_software_renderer(j.renderer))
        j.why.push_back("a software renderer computes slowly, so streaming weighs less");
    return j;
}

Judgement combined_ratio(const FinishedRun& run) {
    const Bars bars(run);
    Judgement j{.renderer = bars.renderer()};
    for (const std::string optimizer : optimizers) {
        const double ratio = bars.total(combined_passes, optimizer) / bars.total(paper_passes, optimizer);
        j.measure(ratio <= 0.95, fmt::format("{} {:.2f}", optimizer, ratio));
        j.values[optimizer] = ratio;
    }
    j.why = {"time of the combined passes over that of the paper's, the same problems to the same end"};
    return j;
}

Judgement switching_share(const FinishedRun& run) {
    const Bars bars(run);
    Judgement j{.renderer = bars.renderer()};
    const double cg = bars.share("switching_s", paper_passes, "cg"), sd = bars.share("switching_s", paper_passes, "sd");
    j.measure(cg > sd, "cg " + percent(cg));
    j.measure(sd >= 0.35 && sd <= 0.65, "sd " + percent(sd));
    j.values = {{"cg", cg}, {"sd", sd}};
    j.why = {"time of the same commands cut to one texel, over the full time"};
    return j;
}

// Figure 9.

struct ErrorRow {
    double psnr, ape;
    std::string renderer;
};
ErrorRow one_term(const CsvTable& t, const std::string& dataset, const std::string& method) {
    for (size_t i = 0; i < t.row_count(); ++i)
        if (t.text(i, "dataset") == dataset && t.text(i, "method") == method && t.number(i, "terms") == 1)
            return {t.number(i, "train_psnr_db"), t.number(i, "train_ape"), t.text(i, "renderer")};
    throw UserError(fmt::format("errors.csv: no row {}, {}, 1 term; run fig9_error again", dataset, method));
}

Judgement above_pca(const FinishedRun& run) {
    const CsvTable t = run.table("errors.csv");
    Judgement j{.why = {"one term, training photographs"}};
    for (const std::string dataset : {"star", "bust"}) {
        const ErrorRow pca = one_term(t, dataset, "pca"), nonlinear = one_term(t, dataset, "cpu-high");
        const double gain = nonlinear.psnr - pca.psnr;
        j.measure(gain > 0 && nonlinear.ape < pca.ape, fmt::format("{} {:+.2f} dB", dataset, gain));
        j.values[dataset] = {{"psnr_difference_db", gain}, {"ape_difference", nonlinear.ape - pca.ape}};
        j.why.push_back(fmt::format("{}: {:.2f} against {:.2f} dB, APE {:.2f} against {:.2f}", dataset, nonlinear.psnr,
                                    pca.psnr, nonlinear.ape, pca.ape));
        j.renderer = nonlinear.renderer;
    }
    return j;
}

Judgement half_as_good(const FinishedRun& run) {
    const CsvTable t = run.table("errors.csv");
    Judgement j;
    for (const std::string dataset : {"star", "bust"}) {
        const ErrorRow cpu = one_term(t, dataset, "cpu-low"), half = one_term(t, dataset, "fragment-fp16");
        j.measure(std::abs(half.psnr - cpu.psnr) <= 0.2, fmt::format("{} {:+.3f} dB", dataset, half.psnr - cpu.psnr));
        j.values[dataset] = half.psnr - cpu.psnr;
        j.renderer = half.renderer;
    }
    j.why = {
        "OpenGL with 16-bit floats less the CPU with 32-bit floats, same resolution, one term, training photographs"};
    return j;
}

// Figure 10.

Judgement utilization(const FinishedRun& run) {
    const CsvTable t = run.table("utilization.csv");
    Judgement j{.verdict = "not comparable", .what = "shares of this device's own peaks, SD: "};
    for (size_t i = 0; i < t.row_count(); ++i) {
        const std::string &problem = t.text(i, "problem"), &passes = t.text(i, "passes");
        const std::string& optimizer = t.text(i, "optimizer");
        const double computation = t.number(i, "computation_share"), bandwidth = t.number(i, "bandwidth_share");
        const double reads = t.number(i, "reads_share");
        j.values[problem][passes][optimizer] = {
            {"computation", computation}, {"bandwidth", bandwidth}, {"reads", reads}};
        j.renderer = t.text(i, "renderer");
        if (passes == "paper" && optimizer == optimizers[1])
            j.measures.push_back(fmt::format("{}: computation {}, texture reads {}, memory bandwidth {}", problem,
                                             percent(computation), percent(reads), percent(bandwidth)));
        else
            j.why.push_back(fmt::format("{}, {} passes, {}: {}, {}, {}", problem, passes, optimizer,
                                        percent(computation), percent(reads), percent(bandwidth)));
    }
    j.why.insert(j.why.begin(), "the paper's share is of a Radeon 9700's peaks");
    return j;
}

// Streaming.

/// Rows of the paper's passes; each(row, problem, optimizer, source). The largest share of cached pages, and the
/// renderer.
template <class Each>
double each_paper_row(const CsvTable& t, Judgement& j, const Each& each) {
    double cached = 0;
    for (size_t i = 0; i < t.row_count(); ++i) {
        if (t.text(i, "passes") != "paper") continue;
        each(i, t.text(i, "problem"), t.text(i, "optimizer"), t.text(i, "source"));
        cached = std::max(cached, t.number(i, "cached_share"));
        j.renderer = t.text(i, "renderer");
    }
    return cached;
}

/// The disk must have been cold.
void demand_cold(Judgement& j, double cached) {
    j.values["cached_share"] = cached;
    if (cached <= 0.01) return;
    j.verdict = "not run";
    j.why = {fmt::format("the images did not come from a cold disk: {} of their pages were cached", percent(cached))};
}

Judgement lafortune_streaming(const FinishedRun& run) {
    const CsvTable t = run.table("times.csv");
    Judgement j;
    const double cached = each_paper_row(
        t, j, [&](size_t i, const std::string& problem, const std::string& optimizer, const std::string& source) {
            if (problem != "Lafortune" || source != "disk-cold") return;
            const double share = t.number(i, "streaming_share");
            j.measure(share >= 0.5 && share <= 0.9, fmt::format("{} {}", optimizer, percent(share)));
            j.values[optimizer] = share;
        });
    if (j.measures.empty()) throw UserError("times.csv: no row of Lafortune; run streaming again");
    j.why = {"reading images from a cold disk and handing them to OpenGL, over the time of an iteration"};
    if (is_software_renderer(j.renderer))
        j.why.push_back("a software renderer computes slowly, so streaming weighs less");
    demand_cold(j, cached);
    return j;
}

Judgement memory_over_disk(const FinishedRun& run) {
    const CsvTable t = run.table("times.csv");
    Judgement j{.what = "time from host memory over that from a cold disk: "};
    bool enough = true;
    const double cached = each_paper_row(
        t, j, [&](size_t i, const std::string& problem, const std::string& optimizer, const std::string& source) {
            const double ratio = t.number(i, "over_disk_cold");
            if (source == "device")
                j.why.push_back(fmt::format("{}, {}, kept on the device {:.3f}", problem, optimizer, ratio));
            if (source != "memory") return;
            const double faster = t.number(i, "faster_repetitions"), repetitions = t.number(i, "repetitions");
            j.measure(ratio <= 0.95 && faster == repetitions, fmt::format("{}, {} {:.3f}", problem, optimizer, ratio));
            j.values[problem][optimizer] = {{"ratio", ratio}, {"faster", faster}, {"repetitions", repetitions}};
            enough = enough && repetitions >= 5;
        });
    if (j.measures.empty()) throw UserError("times.csv: no row of host memory; run streaming again");
    j.why.insert(j.why.begin(), "medians of alternated repetitions; significant if host memory was faster in each");
    j.demand(enough, "5 repetitions: as many heads in a row are 3 % likely by chance");
    demand_cold(j, cached);
    return j;
}

// Stopping.

Judgement idle_before_arrival(const FinishedRun& run) {
    const CsvTable t = run.table("rules.csv");
    Judgement j{.verdict = "does not hold", .what = "idle and arrived at a threshold of 1/255: "};
    std::map<std::string, bool> idle;  // by rule: with every optimizer
    for (size_t i = 0; i < t.row_count(); ++i) {
        if (t.number(i, "levels") == 0) continue;
        const std::string &rule = t.text(i, "rule"), &optimizer = t.text(i, "optimizer");
        const double half = t.number(i, "first_below_half"), median = t.number(i, "median_reached");
        const auto when = [](double k) { return k < 0 ? "never" : fmt::format("at {:g}", k); };
        const std::string text =
            fmt::format("{}, {}: half idle {}, median arrived {}", rule, optimizer, when(half), when(median));
        if (t.number(i, "levels") != 1) {
            j.why.push_back(fmt::format("{}/255, {}", t.text(i, "levels"), text));
            continue;
        }
        const bool early = t.number(i, "idle_before_arrival") == 1;
        idle[rule] = early && (!idle.contains(rule) || idle[rule]);
        j.measures.push_back(text);
        j.values[rule][optimizer] = {{"first_below_half", half}, {"median_reached", median}};
    }
    if (idle.empty()) throw UserError("rules.csv: no threshold of 1 level; run stopping again");
    for (const auto& [rule, early] : idle)
        if (early) j.verdict = "holds";
    j.why.insert(j.why.begin(), "iterations; a problem has arrived within 1.01 of the best error of any solver");
    j.demand(run.setting("tolerance") == 1.01 && run.setting("lambda") == 1e-4, "lambda = 1e-4 and 1.01 E_best");
    return j;
}

// Memory and cost.

/// Each line's name and slope; to be 1 within the tolerance.
std::vector<std::string> measure_slopes(Judgement& j, const Lines& lines, double tolerance, Json& values) {
    if (lines.empty()) throw UserError("no rows; run scaling again");
    std::vector<std::string> text;
    for (const auto& [name, points] : lines) {
        if (points.size() < 3) throw UserError(fmt::format("{}: a slope needs three sizes; run scaling again", name));
        const double slope = log_slope(points);
        j.require(std::abs(slope - 1) <= tolerance);
        values["slope"][name] = slope;
        text.push_back(fmt::format("{} {:.3f}", name, slope));
    }
    return text;
}

Lines memory_lines(const CsvTable& t) {
    Lines lines;
    for (size_t i = 0; i < t.row_count(); ++i)
        lines[fmt::format("{} {} {}", t.text(i, "engine"), t.text(i, "passes"), t.text(i, "storage"))].emplace_back(
            t.number(i, "parameters"), t.number(i, "allocated_bytes"));
    return lines;
}

Judgement memory_linear(const FinishedRun& run) {
    const CsvTable t = run.table("memory.csv");
    Judgement j{.what = "slope of bytes over parameters: "};
    double worst = 0;
    for (size_t i = 0; i < t.row_count(); ++i)
        worst = std::max(worst, std::abs(t.number(i, "allocated_bytes") / t.number(i, "planned_bytes") - 1));
    j.require(worst <= 0.05);
    j.measures = measure_slopes(j, memory_lines(t), 0.05, j.values);
    j.values["worst_deviation_from_plan"] = worst;
    j.why = {fmt::format("allocations are within {} of radiafit plan", percent(worst))};
    const CsvTable times = run.table("time.csv");
    for (size_t i = 0; i < times.row_count(); ++i)
        if (times.text(i, "engine").starts_with("fragment")) j.renderer = times.text(i, "renderer");
    return j;
}

Judgement cost_linear(const FinishedRun& run) {
    const CsvTable t = run.table("time.csv");
    Judgement j{.what = "slope of time over samples: "};
    Lines times;
    for (size_t i = 0; i < t.row_count(); ++i) {
        times[t.text(i, "engine")].emplace_back(t.number(i, "samples"), t.number(i, "seconds_per_iteration"));
        if (j.renderer.find(t.text(i, "renderer")) == std::string::npos)
            j.renderer += (j.renderer.empty() ? "" : "; ") + t.text(i, "renderer");
    }
    j.measures = measure_slopes(j, times, 0.1, j.values["time"]);
    j.why = measure_slopes(j, memory_lines(run.table("memory.csv")), 0.1, j.values["memory"]);
    j.why.front() = "slope of bytes over parameters: " + j.why.front();
    return j;
}

Judgement pixels_and_texels(const FinishedRun& run) {
    const CsvTable t = run.table("datasets.csv");
    Judgement j;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const std::string& name = t.text(i, "dataset");
        const double median = t.number(i, "median_samples_per_texel"), shared = t.number(i, "shared_texels");
        const double kept = t.number(i, "kept_share");
        j.measure(median >= 10 && shared == 0, fmt::format("{} median {:g} samples per texel", name, median));
        j.why.push_back(fmt::format("{}: {} of the pixels kept, {:g} texels with two pixels of one image", name,
                                    percent(kept), shared));
        j.values[name] = {{"median_samples_per_texel", median}, {"kept_share", kept}, {"shared_texels", shared}};
    }
    demand_star_and_bust(j, t);
    return j;
}

constexpr Claim table[] = {
    {"C1", "6.1, Fig. 7", "CG needs about a tenth of SD's iterations",
     "median ratio of iterations to 1.01 of the best error is at least 5, on star and bust", "fig7_convergence",
     iteration_ratio},
    {"C2", "6.1", "CG usually finds a better local minimum",
     "CG's error is below SD's at ten times the iterations for more than half of the problems", "fig7_convergence",
     better_minimum},
    {"C3", "6.2, Fig. 8", "the GPU is more than 5 times faster than the CPU",
     "both ratios of wall time, distribution included, are above 5; not comparable on a software renderer", "fig8_time",
     faster_than_cpu},
    {"C4", "4.3", "distribution takes up to half of the CPU's time",
     "at least 20 % in some run with the paper's record", "fig8_time", distribution_share},
    {"C5", "6.2", "streaming images takes about 20 % of the GPU's time", "10 to 30 %, from disk with a cold page cache",
     "fig8_time", streaming_share},
    {"C6", "6.5", "streaming from disk takes about 70 % of the time for the Lafortune model",
     "50 to 90 %, from disk with a cold page cache", "streaming", lafortune_streaming},
    {"C7", "6.2", "context switches take about half of SD's time, almost 66 % of CG's",
     "the same commands cut to one texel take 35 to 65 % of SD's time, and more of CG's", "fig8_time", switching_share},
    {"C8", "6.4, Fig. 9", "nonlinear optimization beats PCA at the same high resolution",
     "PSNR higher and APE lower on training photographs", "fig9_error", above_pca},
    {"C9", "6.4, Fig. 9", "the GPU at 16-bit floats about equals the CPU at low resolution",
     "PSNR differs by at most 0.2 dB", "fig9_error", half_as_good},
    {"C10", "6.5, Fig. 10", "29 % utilization for the light field map",
     "not comparable; operations counted over the peaks of the same device", "fig10_utilization", utilization},
    {"C11", "6.5", "streaming from host memory raises utilization", "ratio of times at most 0.95, significant",
     "streaming", memory_over_disk},
    {"C12", "6.5", "combining passes cuts the switch overhead and redundant reads", "ratio of times at most 0.95",
     "fig8_time", combined_ratio},
    {"C13", "4.3", "redistributing every iteration costs almost nothing",
     "time with redistribution over time with cached samples at most 1.1", nullptr, nullptr},
    {"C14", "6.3", "memory is O(N)",
     "bytes allocated = radiafit plan within 5 %; slope of log bytes over log N = 1 ± 0.05", "scaling", memory_linear},
    {"C15", "6.6", "limited scatter and gather would remove the dependence on the sampling rate",
     "slope of log time over log texels: gather at least 0.5, scatter at most 0.2", nullptr, nullptr},
    {"C16", "5.3.2", "threshold stopping rules are too restrictive, and utilization falls as problems finish",
     "under a threshold rule less than half of the problems are active before the median one is within 1.01 E_best",
     "stopping", idle_before_arrival},
    {"C17", "5.1.1", "a pixel lands in one texel, and every parameter still gets many samples",
     "median of at least 10 samples per texel; no texel takes two pixels of one image, as distribution sees to",
     "table1_datasets", pixels_and_texels},
    {"C18", "3.2", "an iteration costs O(S), memory O(N)", "slopes 1 ± 0.1", "scaling", cost_linear},
};

}  // namespace

std::span<const Claim> claims() { return table; }

}  // namespace radiafit
