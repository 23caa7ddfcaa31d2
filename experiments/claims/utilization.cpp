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

std::string storage_of(const FinishedRun& run) {
    const std::string storage = run.text("storage");
    return storage.empty() ? "fp32" : storage;
}

// What Section 6.5 states of a Radeon 9700: operations and 64-bit texture reads a second.
constexpr double chip_operations = 2.6e9, chip_reads = 0.65e9;

Evidence utilization(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv"), table = run.table("work.csv"), peaks = run.table("peaks.csv");
    Evidence e{.renderer = run.device()};
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
                    e.measure("use", of + ", arithmetic", computation, "%");
                    e.measure("use", of + ", texture reads", fetching, "%");
                } else {
                    e.beside.push_back(fmt::format("{}, combined passes: arithmetic {}, texture reads {}", of,
                                                   percent(computation.value), percent(fetching.value)));
                }
            }
    const auto spread = [](const Rounds& rates) {
        const std::vector<double> all = values(rates);
        return fmt::format("{:.3g} G/s ({:.3g} to {:.3g} in {} repetitions)", 1e-9 * median(all),
                           1e-9 * std::ranges::min(all), 1e-9 * std::ranges::max(all), all.size());
    };
    e.beside.push_back(
        fmt::format("peaks measured beside each iteration: {} operations, {} texture reads; the paper's "
                    "Radeon 9700: 2.6 and 0.65 G/s",
                    spread(operations), spread(reads)));
    e.sentence = fmt::format(
        "The light field map by steepest descent, as in Figure 10, reaches {} of this device's peak of arithmetic and "
        "{} of its peak of texture reads; the paper's 29 % were of a Radeon 9700's.",
        e.measures[0].value_text(), e.measures[1].value_text());
    return e;
}

Evidence cheap_penalties(const FinishedRun& run) {
    const CsvTable t = run.table("iterations.csv"), table = run.table("work.csv");
    Evidence e{.renderer = run.device()};
    need_all_images(e, run);
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
            e.measure("time", of + ", time", time, "%");
            e.measure("operations", of + ", operations", operations, "%");
        }
    const auto most = [&](const char* what) {
        double share = 0;
        for (const Measure& m : e.measures)
            if (m.of.ends_with(what)) share = std::max(share, m.figure.value);
        return percent(share);
    };
    e.beside.push_back(
        "each share is the most that it can be, and its interval's lower end the least: with and without "
        "the gradient's last step, which adds penalties to the sums over samples");
    e.sentence = fmt::format(
        "Regularization and bounds take at most {} of an iteration's time and {} of the operations that its programs "
        "declare, with the paper's passes.",
        most("time"), most("operations"));
    return e;
}

/// A machine of one disk and one kind of switch, by the pace of its chip.
struct Machine {
    double seconds_a_byte, seconds_a_switch;
};

/// How an iteration's time divides.
struct Shares {
    double streaming, switching, computation;
};

/// What an iteration of the paper's passes asks of the chip: seconds of computation at least, at the peaks that
/// Section 6.5 states; bytes of images; switches.
struct Load {
    double computing = 0, reading = 0, arithmetic = 0, image_bytes = 0, switches = 0;

    Shares on(const Machine& machine) const {
        const double streaming = image_bytes * machine.seconds_a_byte, switching = switches * machine.seconds_a_switch;
        const double all = streaming + switching + computing;
        return {streaming / all, switching / all, computing / all};
    }
};

// The paper counts instructions, of which one works on up to four components and multiplies and adds; we count each
// component, and a multiply-add as two.
constexpr double most_in_one_instruction = 8;

/// Texture reads of 64 bits, as the paper's peak counts them: of the bytes that passes read.
double chip_sized_reads(const CsvTable& passes, const std::string& problem, const std::string& optimizer) {
    double bytes = 0;
    for (const size_t row : rows_where(passes, {{"problem", problem}, {"optimizer", optimizer}, {"passes", "paper"}}))
        bytes += passes.number(row, "read_bytes");
    return bytes / 8;
}

Load load_of(const FinishedRun& run, const std::string& problem, const std::string& optimizer) {
    const CsvTable table = run.table("work.csv"), passes = run.table("passes.csv");
    const DeclaredWork work(table, problem, optimizer, "paper");
    Load load{.reading = chip_sized_reads(passes, problem, optimizer) / chip_reads,
              .arithmetic = work("operations") / chip_operations,
              .image_bytes = work("image_bytes"),
              .switches = work("switches")};
    load.computing = std::max(load.reading, load.arithmetic / most_in_one_instruction);
    return load;
}

/// The machine on which the load divides so.
Machine machine_of(const Load& load, double streaming, double switching) {
    const double total = load.computing / (1 - streaming - switching);
    return {streaming * total / load.image_bytes, switching * total / load.switches};
}

Evidence paper_chip(const FinishedRun& run) {
    Evidence e{.renderer = "a model"};
    need_all_images(e, run);
    constexpr double streaming = 0.2, sd_switching = 0.5, cg_switching = 0.66;
    const Load sd = load_of(run, "light field map", "sd"), cg = load_of(run, "light field map", "cg"),
               lafortune = load_of(run, "Lafortune", "sd");
    const Machine machine = machine_of(sd, streaming, sd_switching);
    const Shares of_cg = cg.on(machine), of_lafortune = lafortune.on(machine);
    e.measure("CG, streaming", "CG, streaming; the paper: 20 %", exact(of_cg.streaming), "%");
    e.measure("CG, switching", "CG, switching; the paper: almost 66 %", exact(of_cg.switching), "%");
    e.measure("CG, computation", "CG, computation; the paper: 14 %", exact(of_cg.computation), "%");
    e.measure("Lafortune, streaming", "Lafortune, SD, streaming; the paper: about 70 %", exact(of_lafortune.streaming),
              "%");
    const auto apart = [&](const char* name, const Load& load, double switching) {
        const Machine own = machine_of(load, streaming, switching);
        const std::string of = name;
        e.measure(of + ", apart", of + ", a disk of", exact(1e-6 / own.seconds_a_byte), "MB/s");
        e.measure(of + ", apart", of + ", a switch of", exact(1e6 * own.seconds_a_switch), "µs");
        e.beside.push_back(fmt::format(
            "{}: reads of 64 bits take {:.3g} s at 0.65 G/s, operations between {:.3g} and {:.3g} s at 2.6 G/s, by how "
            "many components an instruction works on; {:.3g} MB of images and {:g} switches; from this optimizer's "
            "shares alone follow a disk of {:.3g} MB/s and switches of {:.3g} µs, at the chip's peak",
            name, load.reading, load.arithmetic / most_in_one_instruction, load.arithmetic, 1e-6 * load.image_bytes,
            load.switches, 1e-6 / own.seconds_a_byte, 1e6 * own.seconds_a_switch));
    };
    apart("SD", sd, sd_switching);
    apart("CG", cg, cg_switching);
    const double needed = cg_switching / (1 - cg_switching) * (cg.computing + cg.image_bytes * machine.seconds_a_byte) /
                          machine.seconds_a_switch;
    e.beside.push_back(fmt::format("for 66 % of switching, CG would need {:.0f} switches where our passes have {:g}",
                                   needed, cg.switches));
    e.beside.push_back(fmt::format("storage of the run: {}", storage_of(run)));
    e.beside.push_back(
        "29 % utilization is what 20 % of streaming and 50 % of switching leave of SD's time, 30 %, at "
        "the chip's peak: the paper's own figures agree; it states no time in seconds");
    e.sentence = fmt::format(
        "A machine with one disk and one kind of switch, both as SD's shares of 20, 50 and 30 % ask for, streams {} of "
        "CG's time, switches for {} and computes for {}, where the paper says 20, 66 and 14 %, and streams {} of the "
        "Lafortune model's, where it says 70 %.",
        percent(of_cg.streaming), percent(of_cg.switching), percent(of_cg.computation),
        percent(of_lafortune.streaming));
    return e;
}

}  // namespace

std::span<const ClaimCode> utilization_claims() {
    static constexpr ClaimCode table[] = {{"C10", utilization}, {"C20", cheap_penalties}, {"C23", paper_chip}};
    return table;
}

}  // namespace radiafit::harness
