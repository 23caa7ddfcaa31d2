#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "base/error.h"
#include "gl/context.h"
#include "rules.h"

namespace radiafit {
namespace {

constexpr const char* optimizers[] = {"sd", "cg"};
constexpr const char* problems[] = {"light field map", "Lafortune"};
constexpr const char* full_record = "two-step (full record)";
constexpr const char* compact_record = "two-step (compact record)";
constexpr const char* paper_passes = "OpenGL (paper passes)";
constexpr const char* batched_passes = "OpenGL (combined passes)";
constexpr const char* image_by_image = "OpenGL (combined passes, image by image)";

bool is_descent(const std::string& optimizer) { return optimizer == optimizers[0]; }
std::string upper(const std::string& optimizer) { return is_descent(optimizer) ? "SD" : "CG"; }
std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

/// Texts that columns hold.
using Where = std::vector<std::pair<const char*, std::string>>;

/// Rows where they do. Throws UserError if there are none.
std::vector<size_t> rows_where(const CsvTable& t, const Where& where) {
    std::vector<size_t> rows;
    for (size_t i = 0; i < t.row_count(); ++i)
        if (std::ranges::all_of(where, [&](const auto& pair) { return t.text(i, pair.first) == pair.second; }))
            rows.push_back(i);
    if (!rows.empty()) return rows;
    std::vector<std::string> texts;
    for (const auto& [column, text] : where) texts.push_back(text);
    throw UserError(fmt::format("no row of {}; run the experiment again", fmt::join(texts, ", ")));
}

/// A figure by repetition: what is compared is taken within one round.
using Rounds = std::map<int, double>;
using RowValue = std::function<double(size_t row)>;

Rounds rounds(const CsvTable& t, const Where& where, const RowValue& value) {
    Rounds out;
    for (const size_t row : rows_where(t, where)) out[int(t.number(row, "repetition"))] = value(row);
    return out;
}
Rounds rounds(const CsvTable& t, const Where& where, const char* column) {
    return rounds(t, where, [&](size_t row) { return t.number(row, column); });
}

std::vector<double> values(const Rounds& rounds) {
    std::vector<double> out;
    for (const auto& [round, value] : rounds) out.push_back(value);
    return out;
}
double median_of(const Rounds& rounds) { return median(values(rounds)); }

/// Of the rounds that both have.
template <class Operation>
std::vector<double> each(const Rounds& a, const Rounds& b, const Operation& operation) {
    std::vector<double> out;
    for (const auto& [round, value] : a)
        if (const auto other = b.find(round); other != b.end()) out.push_back(operation(value, other->second));
    return out;
}
std::vector<double> ratios(const Rounds& a, const Rounds& b) { return each(a, b, std::divides()); }

/// For claims about images from a cold disk: not run unless they were, by the most pages that were cached.
void demand_cold(Judgement& j, const FinishedRun& run, const CsvTable& t, const Where& where) {
    double cached = 0;
    for (const size_t row : rows_where(t, where)) cached = std::max(cached, t.number(row, "cached_share"));
    const std::string source = run.text("source");
    if (!source.empty() && source != "disk-cold")
        j.not_run = fmt::format("images came from {}, not from a cold disk", source);
    else if (cached > 0.01)
        j.not_run = fmt::format("the disk was not cold: {} of the images' pages were cached", percent(cached));
    j.beside.push_back(fmt::format("at most {} of the images' pages were in the page cache", percent(cached)));
}

// Figure 8.

/// Seconds of a whole fit of as many iterations as the config asks for; OpenGL on a software renderer runs fewer.
Rounds totals(const FinishedRun& run, const CsvTable& t, const std::string& method, const std::string& optimizer,
              const std::string& threads = "") {
    const double iterations = run.setting("iterations");
    const bool opengl = method.starts_with("OpenGL");
    Where where{{"method", method}, {"optimizer", optimizer}};
    if (!opengl) where.emplace_back("iterations", fmt::format("{:g}", iterations));
    if (!threads.empty()) where.emplace_back("threads", threads);
    return rounds(t, where, [&](size_t row) {
        const double further = opengl ? iterations - t.number(row, "iterations") : 0;
        return t.number(row, "total_s") + further * t.number(row, "iteration_s");
    });
}

/// What stands in a column of the two-step solver's rows with the paper's record, in order.
std::set<int> those_of(const CsvTable& t, const char* column) {
    std::set<int> numbers;
    for (const size_t row : rows_where(t, {{"method", full_record}})) numbers.insert(int(t.number(row, column)));
    return numbers;
}

}  // namespace

Judgement faster_than_cpu(const FinishedRun& run) {
    const CsvTable t = run.table("repetitions.csv");
    Judgement j{.renderer = run.device()};
    j.demand_graphics_chip();
    j.demand(run.text("dataset") == "star", "the star");
    j.demand(run.setting("iterations") == 100, "100 iterations");
    std::vector<std::string> found;
    for (const std::string optimizer : optimizers) {
        const Rounds opengl = totals(run, t, paper_passes, optimizer);
        for (const int threads : those_of(t, "threads")) {
            const std::string on = fmt::format("{} thread{}", threads, threads == 1 ? "" : "s");
            const Rounds full = totals(run, t, full_record, optimizer, std::to_string(threads)),
                         compact = totals(run, t, compact_record, optimizer, std::to_string(threads));
            const Rounds& cpu = median_of(full) < median_of(compact) ? full : compact;
            const Figure ratio = median_of_rounds(ratios(cpu, opengl));
            j.measures.push_back(
                {.of = fmt::format("{}, {}", upper(optimizer), on), .figure = ratio, .bound = at_least(5)});
            found.push_back(fmt::format("{} {:.3g} s on {} of the CPU, {:.3g} times OpenGL's {:.3g} s",
                                        upper(optimizer), median_of(cpu), on, ratio.value, median_of(opengl)));
        }
        const std::vector<double> further = ratios(opengl, totals(run, t, batched_passes, optimizer));
        j.beside.push_back(fmt::format("{}: the paper's passes take {:.3g} times as long as combined ones",
                                       upper(optimizer), median(further)));
    }
    j.sentence = fmt::format("{:g} iterations, distribution and reading from disk included, take {}.",
                             run.setting("iterations"), fmt::join(found, "; "));
    if (is_software_renderer(j.renderer))
        j.beside.push_back("a software renderer runs few iterations; its time is reckoned from those");
    return j;
}

Judgement distribution_share(const FinishedRun& run) {
    const CsvTable t = run.table("repetitions.csv");
    const std::set<int> all_iterations = those_of(t, "iterations");
    const std::string threads = std::to_string(*those_of(t, "threads").rbegin());
    Judgement j{.renderer = "cpu, " + threads + " threads"};
    j.demand(all_iterations.contains(25) && all_iterations.contains(100), "25 and 100 iterations");
    std::vector<Measure> all;
    for (const std::string optimizer : optimizers)
        for (const int iterations : all_iterations) {
            const Where where{{"method", full_record},
                              {"optimizer", optimizer},
                              {"threads", threads},
                              {"iterations", std::to_string(iterations)}};
            const auto share = ratios(rounds(t, where, "distribution_s"), rounds(t, where, "total_s"));
            all.push_back({.of = fmt::format("{}, {} iterations", upper(optimizer), iterations),
                           .figure = median_of_rounds(share),
                           .bound = at_least(0.35),
                           .failing = at_most(0.2),
                           .unit = "%"});
        }
    std::ranges::sort(all, std::greater(), [](const Measure& m) { return m.figure.value; });
    j.measures = {all.front()};
    for (size_t i = 1; i < all.size(); ++i)
        j.beside.push_back(fmt::format("{}: {} ({})", all[i].of, all[i].value_text(), all[i].interval_text()));
    j.sentence = fmt::format(
        "Writing every sample to disk with all that the paper's record holds takes up to {} of the CPU's time ({}), "
        "its optimization the rest.",
        all.front().value_text(), all.front().of);
    return j;
}

Judgement streaming_share(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv");
    Judgement j{.renderer = run.device()};
    j.demand_graphics_chip();
    for (const std::string optimizer : optimizers) {
        const Where where{{"method", paper_passes}, {"optimizer", optimizer}};
        const auto share = ratios(rounds(t, where, "streaming_s"), rounds(t, where, "seconds"));
        j.measures.push_back(
            {.of = upper(optimizer), .figure = median_of_rounds(share), .bound = between(0.1, 0.3), .unit = "%"});
    }
    demand_cold(j, run, t, {{"method", paper_passes}});
    j.sentence = fmt::format(
        "Reading photographs from a cold disk and handing them to OpenGL takes {} of an iteration by steepest descent "
        "and {} of one by conjugate gradients; the paper says about 20 %.",
        j.measures[0].value_text(), j.measures[1].value_text());
    return j;
}

Judgement switching_share(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv");
    Judgement j{.renderer = run.device()};
    j.demand_graphics_chip();
    const auto share = [&](const char* optimizer) {
        const Where where{{"method", paper_passes}, {"optimizer", optimizer}};
        const Rounds seconds = rounds(t, where, "seconds");
        return rounds(t, where, [&](size_t row) {
            return t.number(row, "switching_s") / seconds.at(int(t.number(row, "repetition")));
        });
    };
    const Rounds sd = share("sd"), cg = share("cg");
    j.measures = {{.of = "SD", .figure = median_of_rounds(values(sd)), .bound = between(0.35, 0.65), .unit = "%"},
                  {.of = "CG's share less SD's",
                   .figure = median_of_rounds(each(cg, sd, std::minus())),
                   .bound = at_least(0),
                   .unit = "%"}};
    j.beside.push_back(fmt::format("CG: {}", percent(median_of(cg))));
    j.sentence = fmt::format(
        "The same commands cut to one texel, so that nothing but switching from pass to pass is left, take {} of an "
        "iteration by steepest descent and {} of one by conjugate gradients; the paper says about 50 % and 66 %.",
        percent(median_of(sd)), percent(median_of(cg)));
    return j;
}

Judgement combined_passes(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv"), work = run.table("work.csv");
    Judgement j{.renderer = run.device()};
    j.demand_graphics_chip();
    std::vector<std::string> found;
    for (const std::string optimizer : optimizers) {
        const auto of = [&](const char* method, const char* column) {
            return rounds(t, {{"method", method}, {"optimizer", optimizer}}, column);
        };
        const auto reads = [&](const char* method) {
            return work.number(rows_where(work, {{"method", method}, {"optimizer", optimizer}}).front(), "reads");
        };
        const Figure switching =
            median_of_rounds(ratios(of(image_by_image, "switching_s"), of(paper_passes, "switching_s")));
        const double less_reads = reads(image_by_image) / reads(paper_passes);
        j.measures.push_back({.of = upper(optimizer) + ", switching", .figure = switching, .bound = at_most(0.7)});
        j.measures.push_back(
            {.of = upper(optimizer) + ", texture reads", .figure = exact(less_reads), .bound = at_most(0.7)});
        found.push_back(fmt::format("{:.2g} times the switching and {:.2g} times the texture reads ({})",
                                    switching.value, less_reads, upper(optimizer)));
        j.beside.push_back(
            fmt::format("{}: the whole iteration takes {:.2g} times as long image by image, and {:.2g} times where "
                        "passes take four images together, with {:.2g} times the switching and {:.2g} times the reads",
                        upper(optimizer), median(ratios(of(image_by_image, "seconds"), of(paper_passes, "seconds"))),
                        median(ratios(of(batched_passes, "seconds"), of(paper_passes, "seconds"))),
                        median(ratios(of(batched_passes, "switching_s"), of(paper_passes, "switching_s"))),
                        reads(batched_passes) / reads(paper_passes)));
    }
    j.sentence = fmt::format(
        "Passes combined by several render targets and longer programs, one image at a time as in the paper, leave {} "
        "of what the paper's passes have.",
        fmt::join(found, " and "));
    return j;
}

// Streaming.

namespace {

/// Seconds of an iteration, or of its streaming, with images from `source`.
Rounds streamed(const CsvTable& t, const std::string& problem, const std::string& passes, const std::string& source,
                const std::string& optimizer, bool streaming = false) {
    return rounds(t, {{"problem", problem}, {"passes", passes}, {"source", source}}, [&, streaming](size_t row) {
        const double direction = t.number(row, streaming ? "direction_streaming_s" : "direction_s");
        return direction + (is_descent(optimizer) ? 0 : t.number(row, streaming ? "line_streaming_s" : "line_s"));
    });
}

}  // namespace

Judgement lafortune_streaming(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv");
    Judgement j{.renderer = run.device()};
    j.demand_graphics_chip();
    for (const std::string optimizer : optimizers) {
        const Rounds seconds = streamed(t, "Lafortune", "paper", "disk-cold", optimizer),
                     streaming = streamed(t, "Lafortune", "paper", "disk-cold", optimizer, true);
        j.measures.push_back({.of = upper(optimizer),
                              .figure = median_of_rounds(ratios(streaming, seconds)),
                              .bound = between(0.5, 0.9),
                              .unit = "%"});
    }
    demand_cold(j, run, t, {{"problem", "Lafortune"}, {"passes", "paper"}, {"source", "disk-cold"}});
    j.sentence = fmt::format(
        "Fitting Lafortune's model with the paper's passes, streaming photographs from a cold disk takes {} of an "
        "iteration by steepest descent and {} of one by conjugate gradients; the paper says about 70 %.",
        j.measures[0].value_text(), j.measures[1].value_text());
    return j;
}

Judgement memory_over_disk(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv");
    Judgement j{.renderer = run.device()};
    j.demand_graphics_chip();
    for (const std::string problem : problems)
        for (const std::string passes : {"paper", "combined"})
            for (const std::string optimizer : optimizers) {
                const Rounds disk = streamed(t, problem, passes, "disk-cold", optimizer);
                const std::string of = fmt::format("{}, {} passes, {}", problem, passes, upper(optimizer));
                j.measures.push_back(
                    {.of = of,
                     .figure = median_of_rounds(ratios(streamed(t, problem, passes, "memory", optimizer), disk)),
                     .bound = at_most(1)});
                j.beside.push_back(
                    fmt::format("{}: {:.3g} from the page cache, {:.3g} kept on the device", of,
                                median(ratios(streamed(t, problem, passes, "disk", optimizer), disk)),
                                median(ratios(streamed(t, problem, passes, "device", optimizer), disk))));
            }
    demand_cold(j, run, t, {{"source", "disk-cold"}});
    const auto [least, most] =
        std::ranges::minmax_element(j.measures, {}, [](const Measure& m) { return m.figure.value; });
    j.sentence = fmt::format(
        "With photographs from host memory an iteration takes between {} ({}) and {} ({}) of its time with photographs "
        "from a cold disk.",
        percent(least->figure.value), least->of, percent(most->figure.value), most->of);
    return j;
}

// Figure 10.

namespace {

/// What an iteration's passes declare; by the names of work.csv's columns.
class DeclaredWork {
public:
    DeclaredWork(const CsvTable& work, const std::string& problem, const std::string& optimizer,
                 const std::string& passes)
        : work_(work),
          row_(rows_where(work, {{"problem", problem}, {"optimizer", optimizer}, {"passes", passes}}).front()) {}
    double operator()(const char* column) const { return work_.number(row_, column); }

private:
    const CsvTable& work_;
    size_t row_;
};

// What Section 6.5 states of a Radeon 9700: operations and 64-bit texture reads a second.
constexpr double chip_operations = 2.6e9, chip_reads = 0.65e9;

}  // namespace

Judgement utilization(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv"), table = run.table("work.csv"), peaks = run.table("peaks.csv");
    Judgement j{.renderer = run.device(),
                .no_rule = "the paper's share is of a Radeon 9700's peaks, and our text of the paper lost the bars"};
    const Rounds operations = rounds(peaks, {{"peak", "operations of fragments"}}, "per_second"),
                 reads = rounds(peaks, {{"peak", "texture reads"}}, "per_second");
    for (const std::string problem : problems)
        for (const std::string optimizer : optimizers)
            for (const std::string passes : {"paper", "combined"}) {
                const Rounds seconds =
                    rounds(t, {{"problem", problem}, {"optimizer", optimizer}, {"passes", passes}}, "seconds");
                const DeclaredWork work(table, problem, optimizer, passes);
                const auto share = [&](const char* amount, const Rounds& peak) {
                    return median_of_rounds(
                        each(seconds, peak, [&](double s, double rate) { return work(amount) / s / rate; }));
                };
                const Figure computation = share("operations", operations), fetching = share("reads", reads);
                const std::string of = fmt::format("{}, {}", problem, upper(optimizer));
                if (passes == "paper") {
                    j.measures.push_back({.of = of + ", arithmetic", .figure = computation, .bound = {}, .unit = "%"});
                    j.measures.push_back({.of = of + ", texture reads", .figure = fetching, .bound = {}, .unit = "%"});
                } else {
                    j.beside.push_back(fmt::format("{}, combined passes: arithmetic {}, texture reads {}", of,
                                                   percent(computation.value), percent(fetching.value)));
                }
            }
    const auto spread = [](const Rounds& rates) {
        const std::vector<double> all = values(rates);
        return fmt::format("{:.3g} G/s ({:.3g} to {:.3g} in {} repetitions)", 1e-9 * median(all),
                           1e-9 * std::ranges::min(all), 1e-9 * std::ranges::max(all), all.size());
    };
    j.beside.push_back(
        fmt::format("peaks measured beside each iteration: {} operations, {} texture reads; the paper's "
                    "Radeon 9700: 2.6 and 0.65 G/s",
                    spread(operations), spread(reads)));
    j.sentence = fmt::format(
        "The light field map by steepest descent, as in Figure 10, reaches {} of this device's peak of arithmetic and "
        "{} of its peak of texture reads; the paper's 29 % were of a Radeon 9700's.",
        j.measures[0].value_text(), j.measures[1].value_text());
    return j;
}

Judgement cheap_penalties(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv"), table = run.table("work.csv");
    Judgement j{.renderer = run.device()};
    for (const std::string problem : problems)
        for (const std::string optimizer : optimizers) {
            const Where where{{"problem", problem}, {"optimizer", optimizer}, {"passes", "paper"}};
            const DeclaredWork work(table, problem, optimizer, "paper");
            const double alone = work("penalty_operations"), shared = work("shared_operations");
            // The gradient's last step adds penalties to the sums over samples: with it this is the most that they
            // can take, without it the least.
            Figure time = median_of_rounds(ratios(rounds(t, where, "penalties_s"), rounds(t, where, "seconds")));
            if (time.interval) time.interval->low *= alone / (alone + shared);
            const double all = work("operations");
            const Figure operations{(alone + shared) / all, Interval{alone / all, (alone + shared) / all}};
            const std::string of = fmt::format("{}, {}", problem, upper(optimizer));
            j.measures.push_back({.of = of + ", time", .figure = time, .bound = at_most(0.05), .unit = "%"});
            j.measures.push_back(
                {.of = of + ", operations", .figure = operations, .bound = at_most(0.05), .unit = "%"});
        }
    const auto most = [&](const char* what) {
        double share = 0;
        for (const Measure& m : j.measures)
            if (m.of.ends_with(what)) share = std::max(share, m.figure.value);
        return percent(share);
    };
    j.beside.push_back(
        "each share is the most that it can be, and its interval's lower end the least: with and without "
        "the gradient's last step, which adds penalties to the sums over samples");
    j.sentence = fmt::format(
        "Regularization and bounds take at most {} of an iteration's time and {} of the operations that its programs "
        "declare, with the paper's passes.",
        most("time"), most("operations"));
    return j;
}

Judgement paper_chip(const FinishedRun& run) {
    const CsvTable table = run.table("work.csv");
    Judgement j{.renderer = "a model",
                .no_rule =
                    "a model of another machine, from the declared work of our passes and the peaks that the "
                    "paper states"};
    // The paper counts instructions, of which one works on up to four components and multiplies and adds; we count
    // each component, and a multiply-add as two.
    constexpr double most_in_one_instruction = 8;
    constexpr double streaming = 0.2;
    // Of machines of that time, as is well known; not stated by the paper.
    constexpr double least_disk = 20e6, most_switch = 1e-3;
    std::vector<std::string> found;
    bool plausible = true;
    for (const std::string optimizer : optimizers) {
        const double switching = is_descent(optimizer) ? 0.5 : 0.66;
        const DeclaredWork work(table, "light field map", optimizer, "paper");
        const double reading = work("reads") / chip_reads;
        const double arithmetic = work("operations") / chip_operations;
        const double computing = std::max(reading, arithmetic / most_in_one_instruction);
        // What the paper's shares leave is computation.
        const double total = computing / (1 - streaming - switching);
        const double disk = work("image_bytes") / (streaming * total);
        const double one_switch = switching * total / work("switches");
        plausible = plausible && disk >= least_disk && one_switch <= most_switch;
        const auto told = [&](const char* what, double value, const char* unit) {
            j.measures.push_back({.of = fmt::format("{}, {}", upper(optimizer), what),
                                  .figure = exact(value),
                                  .bound = {},
                                  .unit = unit});
        };
        told("computation at least", computing, "s");
        told("an iteration at least, if that is the share the paper leaves it", total, "s");
        told("a disk at most as fast", 1e-6 * disk, "MB/s");
        told("a switch at least as long", 1e6 * one_switch, "µs");
        j.beside.push_back(fmt::format(
            "{}: {:.3g} G texture reads take {:.3g} s at 0.65 G/s; {:.3g} G operations between {:.3g} and {:.3g} s at "
            "2.6 G/s, by how many components an instruction works on; {:.3g} MB of images and {:g} switches",
            upper(optimizer), 1e-9 * work("reads"), reading, 1e-9 * work("operations"),
            arithmetic / most_in_one_instruction, arithmetic, 1e-6 * work("image_bytes"), work("switches")));
        found.push_back(
            fmt::format("{:.3g} s by {}, of an iteration of {:.3g} s with a disk of at most {:.3g} MB/s "
                        "and switches of at least {:.3g} µs",
                        computing, upper(optimizer), total, 1e-6 * disk, 1e6 * one_switch));
    }
    j.beside.push_back(
        fmt::format("the shares are called plausible where the disk may read {:g} MB/s and a switch may "
                    "take no more than {:g} ms, as with machines of that time: our assumption",
                    1e-6 * least_disk, 1e3 * most_switch));
    j.beside.push_back(
        "29 % utilization is what 20 % of streaming and 50 % of switching leave of SD's time, 30 %, at "
        "the chip's peak: the paper's own figures agree; it states no time in seconds");
    j.sentence =
        fmt::format("By a model that takes the paper's shares for granted, a Radeon 9700 computes at least {}: {}.",
                    fmt::join(found, "; "), plausible ? "plausible" : "not plausible");
    return j;
}

}  // namespace radiafit
