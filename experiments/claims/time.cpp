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
void need_cold(Evidence& e, const FinishedRun& run, const CsvTable& t, const Where& where) {
    double cached = 0;
    for (const size_t row : rows_where(t, where)) cached = std::max(cached, t.number(row, "cached_share"));
    const std::string source = run.text("source");
    if (!source.empty() && source != "disk-cold")
        e.not_run = fmt::format("images came from {}, not from a cold disk", source);
    else if (cached > 0.01)
        e.not_run = fmt::format("the disk was not cold: {} of the images' pages were cached", percent(cached));
    e.beside.push_back(fmt::format("at most {} of the images' pages were in the page cache", percent(cached)));
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

Evidence faster_than_cpu(const FinishedRun& run) {
    const CsvTable t = run.table("repetitions.csv");
    Evidence e{.renderer = run.device()};
    e.premise_graphics_chip();
    e.premise("the star", run.text("dataset") == "star", "the star");
    e.premise("100 iterations", run.setting("iterations") == 100, "100 iterations");
    double ran = run.setting("iterations");
    for (const size_t row : rows_where(t, {{"method", paper_passes}})) ran = t.number(row, "iterations");
    std::vector<std::string> found;
    for (const std::string optimizer : optimizers) {
        const Rounds opengl = totals(run, t, paper_passes, optimizer);
        for (const int threads : those_of(t, "threads")) {
            const std::string on = fmt::format("{} thread{}", threads, threads == 1 ? "" : "s");
            const Rounds full = totals(run, t, full_record, optimizer, std::to_string(threads)),
                         compact = totals(run, t, compact_record, optimizer, std::to_string(threads));
            const Rounds& faster = median_of(shared(full, compact)) < median_of(shared(compact, full)) ? full : compact;
            const Rounds cpu = shared(faster, opengl), own = shared(opengl, faster);
            const Figure ratio = median_of_rounds(ratios(cpu, own));
            e.measure("CPU over OpenGL", fmt::format("{}, the CPU's time on {} over OpenGL's", upper(optimizer), on),
                      ratio, "times");
            found.push_back(fmt::format("{} {:.3g} s on {} of the CPU, {:.3g} times OpenGL's {:.3g} s",
                                        upper(optimizer), median_of(cpu), on, ratio.value, median_of(own)));
        }
        const std::vector<double> further = ratios(opengl, totals(run, t, batched_passes, optimizer));
        e.beside.push_back(fmt::format("{}: the paper's passes take {:.3g} times as long as combined ones",
                                       upper(optimizer), median(further)));
    }
    e.sentence =
        fmt::format("{:g} iterations, distribution and reading from disk included, take {}{}.",
                    run.setting("iterations"), fmt::join(found, "; "),
                    ran < run.setting("iterations")
                        ? fmt::format("; OpenGL{} ran {:g} iterations, from which its time is reckoned",
                                      is_software_renderer(e.renderer) ? ", here a software renderer," : "", ran)
                        : "");
    return e;
}

Evidence distribution_share(const FinishedRun& run) {
    const CsvTable t = run.table("repetitions.csv");
    const std::set<int> all_iterations = those_of(t, "iterations"), all_threads = those_of(t, "threads");
    Evidence e{.renderer = fmt::format("cpu, {} threads", *all_threads.rbegin())};
    e.premise("100 iterations", run.setting("iterations") == 100 && all_threads.contains(1),
              "100 iterations on one thread");
    e.premise("25 and 100 iterations", all_iterations.contains(25) && all_iterations.contains(100),
              "25 and 100 iterations");
    struct Share {
        std::string of;
        int threads, iterations;
        Figure distribution, reading, optimization;
    };
    std::vector<Share> all;
    for (const std::string optimizer : optimizers)
        for (const int threads : all_threads)
            for (const int iterations : all_iterations) {
                const Where where{{"method", full_record},
                                  {"optimizer", optimizer},
                                  {"threads", std::to_string(threads)},
                                  {"iterations", std::to_string(iterations)}};
                if (!has_rows_where(t, where)) continue;
                const Rounds total = rounds(t, where, "total_s");
                const auto share = [&](const char* column) {
                    return median_of_rounds(ratios(rounds(t, where, column), total));
                };
                all.push_back({fmt::format("{}, {} iterations, {} thread{}", upper(optimizer), iterations, threads,
                                           threads == 1 ? "" : "s"),
                               threads, iterations, share("distribution_s"), share("streaming_s"),
                               share("optimization_s")});
            }
    std::ranges::stable_sort(all, std::greater(), [](const Share& s) { return s.distribution.value; });
    const Share* largest = nullptr;
    const Share* asked = nullptr;
    for (const Share& s : all) {
        if (!largest && s.threads == *all_threads.rbegin()) largest = &s;
        if (!asked && s.threads == 1 && s.iterations == 100) asked = &s;
        e.beside.push_back(fmt::format("{}: distribution {}, reading the records again {}, optimization {}", s.of,
                                       percent(s.distribution.value), percent(s.reading.value),
                                       percent(s.optimization.value)));
    }
    if (largest) e.measure("largest share", largest->of, largest->distribution, "%");
    if (asked) e.measure("largest share at 100 iterations, one thread", asked->of, asked->distribution, "%");
    const Share& told = asked ? *asked : *largest;
    e.sentence = fmt::format(
        "Of the CPU's time with all that the paper's record holds, finding every sample by the CPU's rasterizer and "
        "writing it to disk takes {} ({}), reading them again {} and optimization {}; the largest share of "
        "distribution, {}, is {}.",
        percent(told.distribution.value), told.of, percent(told.reading.value), percent(told.optimization.value),
        largest->of, percent(largest->distribution.value));
    return e;
}

/// The share of an iteration that streaming from a cold disk takes. seconds(optimizer): of its streaming, and all of
/// it.
Evidence streaming_of(const FinishedRun& run, const CsvTable& t, const Where& where,
                      const std::function<std::pair<Rounds, Rounds>(const std::string& optimizer)>& seconds,
                      const char* fitting, const char* stated) {
    Evidence e{.renderer = run.device()};
    e.premise_graphics_chip();
    for (const std::string optimizer : optimizers) {
        const auto [streaming, all] = seconds(optimizer);
        e.measure("streaming", upper(optimizer), median_of_rounds(ratios(streaming, all)), "%");
    }
    need_cold(e, run, t, where);
    e.sentence = fmt::format(
        "Fitting {} with the paper's passes, reading photographs from a cold disk, converting them and handing them to "
        "OpenGL takes {} of an iteration by steepest descent and {} of one by conjugate gradients; the paper says "
        "about "
        "{}.",
        fitting, e.measures[0].value_text(), e.measures[1].value_text(), stated);
    return e;
}

Evidence streaming_share(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv");
    const auto seconds = [&](const std::string& optimizer) {
        const Where where{{"method", paper_passes}, {"optimizer", optimizer}};
        return std::pair(rounds(t, where, "streaming_s"), rounds(t, where, "seconds"));
    };
    return streaming_of(run, t, {{"method", paper_passes}}, seconds, "light field maps", "20 %");
}

Evidence switching_share(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv");
    Evidence e{.renderer = run.device()};
    e.premise_graphics_chip();
    const auto share = [&](const char* optimizer) {
        const Where where{{"method", paper_passes}, {"optimizer", optimizer}};
        const Rounds seconds = rounds(t, where, "seconds");
        return rounds(t, where, [&](size_t row) {
            return t.number(row, "switching_s") / seconds.at(int(t.number(row, "repetition")));
        });
    };
    const Rounds sd = share("sd"), cg = share("cg");
    e.measure("SD", "SD", median_of_rounds(values(sd)), "%");
    e.measure("CG less SD", "CG's share less SD's of the same round, median",
              median_of_rounds(each(cg, sd, std::minus())), "percentage points");
    e.beside.push_back(
        fmt::format("CG: {}; the median of differences need not be the difference of medians, {:.2g} points",
                    percent(median_of(cg)), 100 * (median_of(cg) - median_of(sd))));
    e.sentence = fmt::format(
        "The same commands cut to one texel, which leaves switching from pass to pass and the triangles that commands "
        "send, take {} of an iteration by steepest descent and {} of one by conjugate gradients; the paper says about "
        "50 % and 66 %.",
        percent(median_of(sd)), percent(median_of(cg)));
    return e;
}

Evidence combined_passes(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv"), work = run.table("work.csv");
    Evidence e{.renderer = run.device()};
    e.premise_graphics_chip();
    std::vector<std::string> found;
    for (const std::string optimizer : optimizers) {
        const auto of = [&](const char* method, const char* column) {
            return rounds(t, {{"method", method}, {"optimizer", optimizer}}, column);
        };
        const auto count = [&](const char* method, const char* column) {
            return work.number(rows_where(work, {{"method", method}, {"optimizer", optimizer}}).front(), column);
        };
        const auto fewer = [&](const char* column, const char* method) {
            return count(method, column) / count(paper_passes, column);
        };
        const Figure time =
            median_of_rounds(ratios(of(image_by_image, "switching_s"), of(paper_passes, "switching_s")));
        const double switches = fewer("switches", image_by_image), reads = fewer("reads", image_by_image);
        e.measure("switches", upper(optimizer) + ", switches", exact(switches), "times");
        e.measure("switching time", upper(optimizer) + ", time of switching", time, "times");
        e.measure("texture reads", upper(optimizer) + ", texture reads", exact(reads), "times");
        found.push_back(fmt::format("{:.2g} times the switches and {:.2g} times the texture reads ({})", switches,
                                    reads, upper(optimizer)));
        e.beside.push_back(
            fmt::format("{}: on this renderer switching takes {} times as long image by image, the whole iteration "
                        "{:.2g} times; where passes take four images together, {:.2g} and {:.2g} times, with {:.2g} "
                        "times the switches and {:.2g} times the reads",
                        upper(optimizer), with_interval(time),
                        median(ratios(of(image_by_image, "seconds"), of(paper_passes, "seconds"))),
                        median(ratios(of(batched_passes, "switching_s"), of(paper_passes, "switching_s"))),
                        median(ratios(of(batched_passes, "seconds"), of(paper_passes, "seconds"))),
                        fewer("switches", batched_passes), fewer("reads", batched_passes)));
    }
    e.sentence = fmt::format(
        "Passes combined by several render targets and longer programs, one image at a time as in the paper, leave {} "
        "of what the paper's passes have.",
        fmt::join(found, " and "));
    return e;
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

Evidence lafortune_streaming(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv");
    const auto seconds = [&](const std::string& optimizer) {
        return std::pair(streamed(t, "Lafortune", "paper", "disk-cold", optimizer, true),
                         streamed(t, "Lafortune", "paper", "disk-cold", optimizer));
    };
    Evidence e = streaming_of(run, t, {{"problem", "Lafortune"}, {"passes", "paper"}, {"source", "disk-cold"}}, seconds,
                              "Lafortune's model", "70 %");
    need_all_images(e, run);
    return e;
}

Evidence memory_over_disk(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv");
    Evidence e{.renderer = run.device()};
    e.premise_graphics_chip();
    need_all_images(e, run);
    std::vector<std::pair<double, std::string>> streaming, iterations, gains;
    for (const std::string problem : problems)
        for (const std::string passes : {"paper", "combined"})
            for (const std::string optimizer : optimizers) {
                const auto of_time = [&](const char* source, bool stream) {
                    return streamed(t, problem, passes, source, optimizer, stream);
                };
                const Rounds disk = of_time("disk-cold", false), disk_streaming = of_time("disk-cold", true);
                const std::string of = fmt::format("{}, {} passes, {}", problem, passes, upper(optimizer));
                const Figure figure = median_of_rounds(ratios(of_time("memory", true), disk_streaming));
                const Figure whole = median_of_rounds(ratios(of_time("memory", false), disk));
                e.measure("streaming, memory over disk", of + ", streaming's time", figure, "times");
                e.measure("iteration, memory over disk", of + ", time of an iteration", whole, "times");
                streaming.emplace_back(figure.value, of);
                iterations.emplace_back(whole.value, of);
                gains.emplace_back(median(ratios(disk_streaming, disk)), of);
                e.beside.push_back(fmt::format(
                    "{}: an iteration takes {:.3g} of its time from a cold disk when images come from the page cache, "
                    "{:.3g} from host memory, {:.3g} kept on the device; streaming from the disk is {} of it",
                    of, median(ratios(of_time("disk", false), disk)), median(ratios(of_time("memory", false), disk)),
                    median(ratios(of_time("device", false), disk)), percent(gains.back().first)));
            }
    need_cold(e, run, t, {{"source", "disk-cold"}});
    const auto between = [](const std::vector<std::pair<double, std::string>>& figures) {
        const auto [least, most] = std::ranges::minmax(figures);
        return fmt::format("between {} ({}) and {} ({})", percent(least.first), least.second, percent(most.first),
                           most.second);
    };
    const auto gain = std::ranges::max(gains);
    e.sentence = fmt::format(
        "Streaming photographs from host memory takes {} of the time that it takes from a cold disk; with this "
        "renderer an iteration can gain no more by it than what streaming takes, at most {} ({}). Whole iterations "
        "take {} of their time from a cold disk.",
        between(streaming), percent(gain.first), gain.second, between(iterations));
    return e;
}

}  // namespace

std::span<const ClaimCode> time_claims() {
    static constexpr ClaimCode table[] = {
        {"C3", faster_than_cpu}, {"C4", distribution_share}, {"C5", streaming_share}, {"C6", lafortune_streaming},
        {"C7", switching_share}, {"C11", memory_over_disk},  {"C12", combined_passes}};
    return table;
}

}  // namespace radiafit::harness
