// The paper's claims, each judged by its rule over the newest results of the other experiments. Nothing is measured
// here, and no verdict is typed in: what has not been run says so.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "experiment.h"
#include "report/csv.h"
#include "report/table.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Judgement {
    std::string verdict;   ///< holds, does not hold, not comparable, not run
    std::string value;     ///< for people
    std::string why;       ///< one sentence
    std::string renderer;  ///< of the figures; empty: what run.json says
    Json values = {};      ///< for programs
};

/// One run's rows.
class Run {
public:
    Run(fs::path folder, const fs::path& results) : folder_(std::move(folder)), name_(fs::relative(folder_, results)) {
        std::ifstream file(folder_ / "run.json");
        json_ = Json::parse(file, nullptr, false);
        if (!json_.is_object())
            throw UserError(fmt::format("{}: no JSON object; delete the run", (folder_ / "run.json").string()));
    }
    std::string name() const { return name_.generic_string(); }
    int threads() const { return json_.value("threads", 0); }
    std::string cpu() const { return json_.value("cpu", "unknown CPU"); }
    std::string profile() const { return json_.value("profile", ""); }
    std::string device() const {
        if (json_.contains("gl_renderer")) return json_.at("gl_renderer").get<std::string>();
        return fmt::format("{}, {} threads", cpu(), threads());
    }
    /// A number of the resolved config. Throws UserError.
    double setting(const char* key) const {
        const Json config = json_.value("config", Json::object());
        if (!config.contains(key) || !config.at(key).is_number())
            throw UserError(fmt::format("{}: config.{} is missing; run the experiment again", name(), key));
        return config.at(key).get<double>();
    }
    std::string text(const char* key) const {
        const Json config = json_.value("config", Json::object());
        return config.contains(key) && config.at(key).is_string() ? config.at(key).get<std::string>() : "";
    }
    CsvTable table(const char* file) const { return CsvTable(folder_ / file); }

private:
    fs::path folder_, name_;
    Json json_;
};

struct Claim {
    const char *id, *section, *states, *rule, *experiment;
    Judgement (*judge)(const Run& run);
};

std::string verdict(bool holds) { return holds ? "holds" : "does not hold"; }
std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }
bool software(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}
/// What a rule demands of a run's configuration and the run hasn't: the claim is not comparable then.
void demand(Judgement& j, bool given, const std::string& what) {
    if (given) return;
    j.verdict = "not comparable";
    j.why += "; the rule asks for " + what;
}
/// Whether a table has rows of both stand-ins.
bool has_star_and_bust(const CsvTable& t) {
    bool star = false, bust = false;
    for (size_t i = 0; i < t.row_count(); ++i) {
        star = star || t.text(i, "dataset") == "star";
        bust = bust || t.text(i, "dataset") == "bust";
    }
    return star && bust;
}
std::string join(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : "; ") + part;
    return text;
}

// Figure 7.

Judgement iteration_ratio(const Run& run) {
    const CsvTable t = run.table("summary.csv");
    Judgement j;
    bool holds = t.row_count() > 0;
    std::vector<std::string> values, why;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const std::string& name = t.text(i, "dataset");
        const auto number = [&](const char* column) {
            j.values[name][column] = t.number(i, column);
            return t.number(i, column);
        };
        const double median = number("ratio_median"), low = number("ratio_quartile1"), high = number("ratio_quartile3");
        holds = holds && median >= 5;
        values.push_back(fmt::format("{} {:.1f} times", name, median));
        why.push_back(fmt::format("{}: quartiles {:.1f} and {:.1f}, SD censored {}, CG unfinished {}", name, low, high,
                                  percent(number("sd_censored_share")), percent(number("cg_unfinished_share"))));
    }
    j.verdict = verdict(holds);
    j.value = join(values);
    j.why = join(why);
    demand(j, run.setting("cap") >= 3000, fmt::format("caps of 3000 iterations, not {:g}", run.setting("cap")));
    demand(j, run.setting("lambda") == 1e-4 && run.setting("tolerance") == 1.01, "lambda = 1e-4 and 1.01 E_best");
    demand(j, has_star_and_bust(t), "star and bust");
    return j;
}

Judgement better_minimum(const Run& run) {
    const CsvTable t = run.table("summary.csv");
    Judgement j;
    bool holds = t.row_count() > 0;
    std::vector<std::string> values;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const double share = t.number(i, "cg_better_at_tenth_share");
        holds = holds && share > 0.5;
        values.push_back(fmt::format("{} {}", t.text(i, "dataset"), percent(share)));
        j.values[t.text(i, "dataset")] = share;
    }
    j.verdict = verdict(holds);
    j.value = join(values);
    const double cap = run.setting("cap");
    j.why = fmt::format("share of problems where CG after {:g} iterations is below SD after {:g}", cap / 10, cap);
    demand(j, has_star_and_bust(t), "star and bust");
    return j;
}

// Figure 8.

/// Row of times.csv.
size_t time_row(const CsvTable& t, const std::string& part, const std::string& method, const std::string& optimizer) {
    for (size_t i = 0; i < t.row_count(); ++i)
        if (t.text(i, "part") == part && t.text(i, "method") == method && t.text(i, "optimizer") == optimizer) return i;
    throw UserError(fmt::format("times.csv: no row {}, {}, {}; run fig8_time again", part, method, optimizer));
}
constexpr const char* paper_passes = "OpenGL (paper passes)";
constexpr const char* combined_passes = "OpenGL (combined passes)";

Judgement faster_than_cpu(const Run& run) {
    const CsvTable t = run.table("times.csv");
    Judgement j;
    bool holds = true;
    std::vector<std::string> values, why;
    for (const std::string optimizer : {"cg", "sd"}) {
        const auto total = [&](const std::string& method) {
            return t.number(time_row(t, "figure", method, optimizer), "total_s");
        };
        const double cpu = std::min(total("two-step (compact record)"), total("two-step (full record)"));
        const double gl = total(paper_passes), combined = total(combined_passes);
        holds = holds && cpu / gl > 5;
        j.values[optimizer] = {{"cpu_over_opengl", cpu / gl}, {"cpu_over_combined", cpu / combined}};
        values.push_back(fmt::format("{} {:.3g}", optimizer, cpu / gl));
        why.push_back(
            fmt::format("{}: CPU {:.2f} s, OpenGL {:.2f} s, combined passes {:.2f} s", optimizer, cpu, gl, combined));
    }
    j.renderer = t.text(time_row(t, "figure", paper_passes, "cg"), "renderer");
    j.verdict = verdict(holds);
    j.value = "CPU time over OpenGL's: " + join(values);
    j.why = fmt::format("{:g} iterations on {} CPU threads; {}", run.setting("iterations"), run.threads(), join(why));
    demand(j, !software(j.renderer), "a GPU, and this renderer is the CPU itself");
    demand(j, run.setting("iterations") == 100, "100 iterations");
    demand(j, run.text("dataset") == "star", "the star");
    return j;
}

Judgement distribution_share(const Run& run) {
    const CsvTable t = run.table("times.csv");
    Judgement j;
    double best = 0;
    std::vector<std::string> values;
    for (size_t i = 0; i < t.row_count(); ++i) {
        if (t.text(i, "method") != "two-step (full record)") continue;
        const double share = t.number(i, "distribution_s") / t.number(i, "total_s");
        best = std::max(best, share);
        values.push_back(
            fmt::format("{} {} iterations {}", t.text(i, "optimizer"), t.text(i, "iterations"), percent(share)));
        j.values[fmt::format("{}_{}", t.text(i, "optimizer"), t.text(i, "iterations"))] = share;
        j.renderer = t.text(i, "renderer");
    }
    j.verdict = verdict(best >= 0.2);
    j.value = join(values);
    j.why =
        "distribution's share of the two-step baseline's time with the paper's record; the rest is its optimization";
    return j;
}

Judgement streaming_share(const Run& run) {
    const CsvTable t = run.table("times.csv");
    Judgement j;
    bool holds = true, cold = true;
    std::vector<std::string> values;
    double cached = 0;
    for (const std::string optimizer : {"cg", "sd"}) {
        const size_t i = time_row(t, "figure", paper_passes, optimizer);
        const double share = t.number(i, "streaming_s") / t.number(i, "total_s");
        holds = holds && share >= 0.1 && share <= 0.3;
        cached = std::max(cached, t.number(i, "cached_share"));
        cold = cold && t.text(i, "source") == "disk-cold" && cached <= 0.01;
        values.push_back(fmt::format("{} {}", optimizer, percent(share)));
        j.values[optimizer] = share;
        j.renderer = t.text(i, "renderer");
    }
    j.values["cached_share"] = cached;
    j.verdict = cold ? verdict(holds) : "not run";
    j.value = join(values);
    j.why =
        cold ? fmt::format("images from disk, {} of their pages in the page cache", percent(cached))
             : fmt::format("the images did not come from a cold disk: {} of their pages were cached", percent(cached));
    if (software(j.renderer)) j.why += "; a software renderer computes slowly, so streaming weighs less";
    return j;
}

Judgement combined_ratio(const Run& run) {
    const CsvTable t = run.table("times.csv");
    Judgement j;
    bool holds = true;
    std::vector<std::string> values;
    for (const std::string optimizer : {"cg", "sd"}) {
        const double ratio = t.number(time_row(t, "figure", combined_passes, optimizer), "total_s") /
                             t.number(time_row(t, "figure", paper_passes, optimizer), "total_s");
        holds = holds && ratio <= 0.95;
        values.push_back(fmt::format("{} {:.2f}", optimizer, ratio));
        j.values[optimizer] = ratio;
    }
    j.renderer = t.text(time_row(t, "figure", paper_passes, "cg"), "renderer");
    j.verdict = verdict(holds);
    j.value = join(values);
    j.why = "time of the combined passes over that of the paper's, the same problems to the same end";
    return j;
}

Judgement switching_share(const Run& run) {
    const CsvTable t = run.table("times.csv");
    Judgement j;
    double share[2];
    for (const auto& [k, optimizer] : {std::pair{0, "cg"}, {1, "sd"}}) {
        const size_t i = time_row(t, "figure", paper_passes, optimizer);
        share[k] = t.number(i, "switching_s") / t.number(i, "total_s");
        j.values[optimizer] = share[k];
        j.renderer = t.text(i, "renderer");
    }
    j.verdict = verdict(share[1] >= 0.35 && share[1] <= 0.65 && share[0] > share[1]);
    j.value = fmt::format("cg {}; sd {}", percent(share[0]), percent(share[1]));
    j.why = "time of the same commands cut to one texel, over the full time";
    return j;
}

// Figure 9.

struct ErrorRow {
    double psnr, ape;
    std::string renderer;
};
ErrorRow error_row(const CsvTable& t, const std::string& dataset, const std::string& method, int terms) {
    for (size_t i = 0; i < t.row_count(); ++i)
        if (t.text(i, "dataset") == dataset && t.text(i, "method") == method && t.number(i, "terms") == terms)
            return {t.number(i, "train_psnr_db"), t.number(i, "train_ape"), t.text(i, "renderer")};
    throw UserError(fmt::format("errors.csv: no row {}, {}, {} terms; run fig9_error again", dataset, method, terms));
}

Judgement above_pca(const Run& run) {
    const CsvTable t = run.table("errors.csv");
    Judgement j;
    bool holds = true;
    std::vector<std::string> values, why;
    for (const std::string dataset : {"star", "bust"}) {
        const ErrorRow pca = error_row(t, dataset, "pca", 1), nonlinear = error_row(t, dataset, "cpu-high", 1);
        holds = holds && nonlinear.psnr > pca.psnr && nonlinear.ape < pca.ape;
        values.push_back(fmt::format("{} {:+.2f} dB", dataset, nonlinear.psnr - pca.psnr));
        why.push_back(fmt::format("{}: {:.2f} against {:.2f} dB, APE {:.2f} against {:.2f}", dataset, nonlinear.psnr,
                                  pca.psnr, nonlinear.ape, pca.ape));
        j.values[dataset] = {{"psnr_difference_db", nonlinear.psnr - pca.psnr},
                             {"ape_difference", nonlinear.ape - pca.ape}};
        j.renderer = nonlinear.renderer;
    }
    j.verdict = verdict(holds);
    j.value = join(values);
    j.why = "one term, training photographs; " + join(why);
    return j;
}

Judgement half_as_good(const Run& run) {
    const CsvTable t = run.table("errors.csv");
    Judgement j;
    bool holds = true;
    std::vector<std::string> values;
    for (const std::string dataset : {"star", "bust"}) {
        const ErrorRow cpu = error_row(t, dataset, "cpu-low", 1), half = error_row(t, dataset, "fragment-fp16", 1);
        holds = holds && std::abs(half.psnr - cpu.psnr) <= 0.2;
        values.push_back(fmt::format("{} {:+.3f} dB", dataset, half.psnr - cpu.psnr));
        j.values[dataset] = half.psnr - cpu.psnr;
        j.renderer = half.renderer;
    }
    j.verdict = verdict(holds);
    j.value = join(values);
    j.why =
        "OpenGL with 16-bit floats less the CPU with 32-bit floats, same resolution, one term, training photographs";
    return j;
}

// Memory and cost.

/// Points of a table by a group's name.
using Series = std::map<std::string, std::vector<std::pair<double, double>>>;

std::vector<std::string> judge_slopes(const Series& series, double tolerance, bool& holds, Json& values) {
    std::vector<std::string> text;
    for (const auto& [name, points] : series) {
        if (points.size() < 3) throw UserError(fmt::format("{}: a slope needs three sizes; run scaling again", name));
        const double slope = log_slope(points);
        holds = holds && std::abs(slope - 1) <= tolerance;
        values["slope"][name] = slope;
        text.push_back(fmt::format("{} {:.3f}", name, slope));
    }
    return text;
}

Series memory_series(const CsvTable& t) {
    Series series;
    for (size_t i = 0; i < t.row_count(); ++i) {
        std::string name = t.text(i, "engine");
        for (const char* column : {"passes", "storage"})
            if (!t.text(i, column).empty()) name += " " + t.text(i, column);
        series[name].emplace_back(t.number(i, "parameters"), t.number(i, "allocated_bytes"));
    }
    return series;
}

Judgement memory_linear(const Run& run) {
    const CsvTable t = run.table("memory.csv");
    Judgement j;
    double worst = 0;
    for (size_t i = 0; i < t.row_count(); ++i)
        worst = std::max(worst, std::abs(t.number(i, "allocated_bytes") / t.number(i, "planned_bytes") - 1));
    bool holds = worst <= 0.05;
    const auto slopes = judge_slopes(memory_series(t), 0.05, holds, j.values);
    j.values["worst_deviation_from_plan"] = worst;
    const CsvTable times = run.table("time.csv");
    for (size_t i = 0; i < times.row_count(); ++i)
        if (times.text(i, "engine").starts_with("fragment")) j.renderer = times.text(i, "renderer");
    j.verdict = verdict(holds);
    j.value = "slope of bytes over parameters: " + join(slopes);
    j.why = fmt::format("allocations are within {} of radiafit plan", percent(worst));
    return j;
}

Judgement cost_linear(const Run& run) {
    const CsvTable t = run.table("time.csv");
    Judgement j;
    bool holds = true;
    Series times;
    for (size_t i = 0; i < t.row_count(); ++i) {
        times[t.text(i, "engine")].emplace_back(t.number(i, "samples"), t.number(i, "seconds_per_iteration"));
        if (j.renderer.find(t.text(i, "renderer")) == std::string::npos)
            j.renderer += (j.renderer.empty() ? "" : "; ") + t.text(i, "renderer");
    }
    const auto slopes = judge_slopes(times, 0.1, holds, j.values["time"]);
    const auto memory = judge_slopes(memory_series(run.table("memory.csv")), 0.1, holds, j.values["memory"]);
    j.verdict = verdict(holds);
    j.value = "slope of time over samples: " + join(slopes);
    j.why = "slope of bytes over parameters: " + join(memory);
    return j;
}

Judgement pixels_and_texels(const Run& run) {
    const CsvTable t = run.table("datasets.csv");
    Judgement j;
    bool holds = t.row_count() > 0;
    std::vector<std::string> values, why;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const std::string& name = t.text(i, "dataset");
        const double median = t.number(i, "median_samples_per_texel"), shared = t.number(i, "shared_texels");
        holds = holds && median >= 10 && shared == 0;
        values.push_back(fmt::format("{} median {:g} samples per texel", name, median));
        why.push_back(fmt::format("{}: {} of the pixels kept, {:g} texels with two pixels of one image", name,
                                  percent(t.number(i, "kept_share")), shared));
        j.values[name] = {
            {"median_samples_per_texel", median}, {"kept_share", t.number(i, "kept_share")}, {"shared_texels", shared}};
    }
    j.verdict = verdict(holds);
    j.value = join(values);
    j.why = join(why);
    demand(j, has_star_and_bust(t), "star and bust");
    return j;
}

constexpr Claim claims[] = {
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
     "50 to 90 %, from disk with a cold page cache", nullptr, nullptr},
    {"C7", "6.2", "context switches take about half of SD's time, almost 66 % of CG's",
     "the same commands cut to one texel take 35 to 65 % of SD's time, and more of CG's", "fig8_time", switching_share},
    {"C8", "6.4, Fig. 9", "nonlinear optimization beats PCA at the same high resolution",
     "PSNR higher and APE lower on training photographs", "fig9_error", above_pca},
    {"C9", "6.4, Fig. 9", "the GPU at 16-bit floats about equals the CPU at low resolution",
     "PSNR differs by at most 0.2 dB", "fig9_error", half_as_good},
    {"C10", "6.5, Fig. 10", "29 % utilization for the light field map",
     "not comparable; operations counted over the peaks of the same device", nullptr, nullptr},
    {"C11", "6.5", "streaming from host memory raises utilization", "ratio of times at most 0.95", nullptr, nullptr},
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
     nullptr, nullptr},
    {"C17", "5.1.1", "a pixel lands in one texel, and every parameter still gets many samples",
     "no texel takes two pixels of one image; median of at least 10 samples per texel", "table1_datasets",
     pixels_and_texels},
    {"C18", "3.2", "an iteration costs O(S), memory O(N)", "slopes 1 ± 0.1", "scaling", cost_linear},
};

struct Row {
    const Claim* claim;
    Judgement judgement;
    std::string run, profile;
};

/// One row for every device that has results of this profile; one that says "not run" if none has.
std::vector<Row> judge_all(const fs::path& results, const std::string& profile) {
    std::vector<Row> rows;
    for (const Claim& claim : claims) {
        const size_t before = rows.size();
        if (!claim.experiment) {
            rows.push_back({&claim, {"not run", "", "no experiment judges it yet", "", {}}, "", profile});
            continue;
        }
        for (const fs::path& folder : newest_runs(results, claim.experiment, profile)) {
            const Run run(folder, results);
            rows.push_back({&claim, {}, run.name(), run.profile()});
            try {
                rows.back().judgement = claim.judge(run);
            } catch (const UserError& e) {  // a run of an older version, or a damaged one
                rows.back().judgement = {"not run", "", e.what(), "", {}};
            }
            Judgement& j = rows.back().judgement;
            if (j.renderer.empty()) j.renderer = run.device();
            // rows say "cpu, 2 threads"
            if (const size_t at = j.renderer.find("cpu,"); at != std::string::npos)
                j.renderer.replace(at, 3, run.cpu());
        }
        if (rows.size() == before)
            rows.push_back(
                {&claim,
                 {"not run",
                  "",
                  fmt::format("no {0} results; make experiments PROFILE={0} ONLY={1}", profile, claim.experiment),
                  "",
                  {}},
                 "",
                 profile});
    }
    return rows;
}

void write_claims(Experiment& experiment) {
    std::string folder = "results";
    experiment.config().read("results", folder);
    experiment.config().finish();
    const fs::path results = experiment.root() / folder;
    const std::vector<Row> rows = judge_all(results, experiment.profile());

    Json json = {{"format", "radiafit-claims"}, {"version", 1}, {"profile", experiment.profile()}};
    Table shown({"claim", "section", "the paper states", "measured here", "verdict", "renderer"});
    Table report({"claim", "section", "the paper states", "rule", "measured here", "verdict", "why", "renderer"});
    for (const Row& row : rows) {
        const auto& [verdict, value, why, renderer, values] = row.judgement;
        const Claim& c = *row.claim;
        json["claims"].push_back({{"id", c.id},
                                  {"section", c.section},
                                  {"paper", c.states},
                                  {"rule", c.rule},
                                  {"value", value},
                                  {"values", values},
                                  {"verdict", verdict},
                                  {"why", why},
                                  {"renderer", renderer},
                                  {"profile", row.profile},
                                  {"run", row.run}});
        shown.add({c.id, c.section, c.states, value, verdict, renderer});
        report.add({c.id, c.section, c.states, c.rule, value, verdict, why, renderer});
    }
    fs::create_directories(results);
    write_file(results / "claims.json", json.dump(2) + "\n");
    write_file(experiment.figures() / "claims.md",
               fmt::format("Claims of the paper, {} profile, {}\n\n{}", experiment.profile(), utc_now().substr(0, 10),
                           report.markdown()));
    log_info("the paper's claims, as measured here\n" + shown.text());
    log_info(fmt::format("verdicts: {} and {}", (results / "claims.json").string(),
                         (experiment.figures() / "claims.md").string()));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("claims", argc, argv, radiafit::write_claims); }
