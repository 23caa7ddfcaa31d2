#include <set>

#include "gl/context.h"
#include "rounds.h"

namespace radiafit::harness {
namespace {

constexpr const char* full_record = "two-step (full record)";
constexpr const char* compact_record = "two-step (compact record)";
constexpr const char* paper_passes = "OpenGL (paper passes)";
constexpr const char* batched_passes = "OpenGL (combined passes)";
constexpr const char* image_by_image = "OpenGL (combined passes, image by image)";

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

/// The values in a column of the two-step solver's rows with the paper's record, in order.
std::set<int> those_of(const CsvTable& t, const char* column) {
    std::set<int> numbers;
    for (const size_t row : rows_where(t, {{"method", full_record}})) numbers.insert(int(t.number(row, column)));
    return numbers;
}

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

/// The share of an iteration that streaming from a cold disk takes. seconds(optimizer): of its streaming, and all of
/// it.
Judgement judge_streaming(const FinishedRun& run, const CsvTable& t, const Where& where, const Bound& bound,
                          const std::function<std::pair<Rounds, Rounds>(const std::string& optimizer)>& seconds,
                          const char* fitting, const char* stated) {
    Judgement j{.renderer = run.device()};
    j.demand_graphics_chip();
    for (const std::string optimizer : optimizers) {
        const auto [streaming, all] = seconds(optimizer);
        j.measures.push_back(
            {.of = upper(optimizer), .figure = median_of_rounds(ratios(streaming, all)), .bound = bound, .unit = "%"});
    }
    demand_cold(j, run, t, where);
    j.sentence = fmt::format(
        "Fitting {} with the paper's passes, reading photographs from a cold disk and handing them to OpenGL takes {} "
        "of "
        "an iteration by steepest descent and {} of one by conjugate gradients; the paper says about {}.",
        fitting, j.measures[0].value_text(), j.measures[1].value_text(), stated);
    return j;
}

Judgement streaming_share(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv");
    const auto seconds = [&](const std::string& optimizer) {
        const Where where{{"method", paper_passes}, {"optimizer", optimizer}};
        return std::pair(rounds(t, where, "streaming_s"), rounds(t, where, "seconds"));
    };
    return judge_streaming(run, t, {{"method", paper_passes}}, between(0.1, 0.3), seconds, "light field maps", "20 %");
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

/// Seconds of an iteration, or of its streaming, with images from `source`.
Rounds streamed(const CsvTable& t, const std::string& problem, const std::string& passes, const std::string& source,
                const std::string& optimizer, bool streaming = false) {
    return rounds(t, {{"problem", problem}, {"passes", passes}, {"source", source}}, [&, streaming](size_t row) {
        const double direction = t.number(row, streaming ? "direction_streaming_s" : "direction_s");
        return direction + (is_descent(optimizer) ? 0 : t.number(row, streaming ? "line_streaming_s" : "line_s"));
    });
}

Judgement lafortune_streaming(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv");
    const auto seconds = [&](const std::string& optimizer) {
        return std::pair(streamed(t, "Lafortune", "paper", "disk-cold", optimizer, true),
                         streamed(t, "Lafortune", "paper", "disk-cold", optimizer));
    };
    return judge_streaming(run, t, {{"problem", "Lafortune"}, {"passes", "paper"}, {"source", "disk-cold"}},
                           between(0.5, 0.9), seconds, "Lafortune's model", "70 %");
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

}  // namespace

std::span<const Claim> time_claims() {
    static constexpr Claim table[] = {
        {"C3", "6.2, Fig. 8", "the GPU is more than 5 times faster than the CPU, for CG and for SD",
         "both ratios of wall time, distribution included, the faster record, are above 5, against one thread and "
         "against all",
         "fig8_time", faster_than_cpu},
        {"C4", "4.3", "distribution takes up to half of the CPU's time",
         "the largest share, over optimizers and 25 and 100 iterations, with the paper's record: above 35 % holds, "
         "below 20 % does not",
         "fig8_time", distribution_share},
        {"C5", "6.2", "streaming images takes about 20 % of the GPU's time",
         "10 to 30 % of an iteration, from disk with a cold page cache", "fig8_time", streaming_share},
        {"C6", "6.5", "streaming from disk takes about 70 % of the time for the Lafortune model",
         "50 to 90 % of an iteration, from disk with a cold page cache", "streaming", lafortune_streaming},
        {"C7", "6.2", "context switches take about half of SD's time, almost 66 % of CG's",
         "the same commands cut to one texel take 35 to 65 % of SD's iteration, and a larger share of CG's",
         "fig8_time", switching_share},
        {"C11", "6.5", "streaming from host memory instead of disk raises utilization",
         "an iteration takes less time in every combination of problem, passes and optimizer", "streaming",
         memory_over_disk},
        {"C12", "6.5", "combining passes cuts the switch overhead and redundant reads",
         "switching time and declared texture reads, image by image, are both at most 0.7 of the paper's passes'",
         "fig8_time", combined_passes},
    };
    return table;
}

}  // namespace radiafit::harness
