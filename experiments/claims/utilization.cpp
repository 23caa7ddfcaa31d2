#include "rounds.h"

namespace radiafit::harness {

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
    // Bounds for machines of that time: common knowledge, not stated by the paper.
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

}  // namespace

std::span<const Claim> utilization_claims() {
    static constexpr Claim table[] = {
        {"C10", "6.5, Fig. 10", "29 % utilization for the light field map",
         "none: operations counted over the peaks of the same device are told beside the paper's", "fig10_utilization",
         utilization},
        {"C20", "3.2", "regularization and bounds cost a negligible part",
         "at most 5 % of an iteration's time, and of its declared operations; the gradient's last step, which adds "
         "them to the sums over samples, counts as theirs for what holds, and not for what does not hold",
         "fig10_utilization", cheap_penalties},
        {"C23", "6.5", "on a Radeon 9700: 20 % streaming, 50 to 66 % switching, the rest computation",
         "none: a model from the declared work of the paper's passes and the peaks the paper states",
         "fig10_utilization", paper_chip},
    };
    return table;
}

}  // namespace radiafit::harness
