#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <ranges>
#include <set>

#include "base/error.h"
#include "base/rng.h"
#include "experiment.h"
#include "rounds.h"

namespace radiafit::harness {
namespace {

/// What scaling's summary writes of the same figures; the rules work from the rows of every round.
constexpr const char *iteration = "iteration", *kept = "iteration, samples kept", *distribution = "distribution";
const std::string paper = "fragment paper", combined = "fragment combined", cpu = "cpu";
const std::string compute_gather = "compute gather", compute_scatter = "compute scatter";

std::string plain_name(const std::string& engine) {
    return engine == paper             ? "OpenGL, the paper's passes"
           : engine == combined        ? "OpenGL, combined passes"
           : engine == compute_gather  ? "OpenGL, compute shaders that gather"
           : engine == compute_scatter ? "OpenGL, compute shaders that scatter"
                                       : "the CPU";
}

double slope_of(const std::map<double, double>& points) { return log_slope({points.begin(), points.end()}); }

/// time.csv: seconds by size, round by round.
class Times {
public:
    explicit Times(const FinishedRun& run) : t_(run.table("time.csv")) {
        for (size_t i = 0; i < t_.row_count(); ++i)
            if (t_.text(i, "engine") == paper) renderer = t_.text(i, "renderer");
        if (renderer.empty()) throw UserError("time.csv: no row of " + paper + "; run scaling again");
    }
    bool has(const char* part, const std::string& engine) const {
        for (size_t i = 0; i < t_.row_count(); ++i)
            if (t_.text(i, "part") == part && t_.text(i, "engine") == engine) return true;
        return false;
    }
    bool has_column(const char* name) const { return std::ranges::count(t_.header(), name) > 0; }
    /// [round]: seconds by size, a column of the table.
    std::vector<std::map<double, double>> rounds(const char* part, const std::string& engine, const char* size,
                                                 const char* what = iteration, const char* time = "seconds") const {
        std::map<int, std::map<double, double>> out;
        for (size_t i = 0; i < t_.row_count(); ++i)
            if (t_.text(i, "part") == part && t_.text(i, "engine") == engine && t_.text(i, "what") == what)
                out[int(t_.number(i, "repetition"))][t_.number(i, size)] = t_.number(i, time);
        if (out.empty())
            throw UserError(fmt::format("time.csv: no row {}, {}, {}; run scaling again", part, engine, what));
        std::vector<std::map<double, double>> list;
        for (const auto& [round, points] : out) list.push_back(points);
        return list;
    }
    /// The slope of log time over log size, one for each round.
    Figure slope(const char* part, const std::string& engine, const char* size, const char* time = "seconds") const {
        std::vector<double> slopes;
        for (const auto& points : rounds(part, engine, size, iteration, time)) {
            if (points.size() < 3) throw UserError("time.csv: a slope needs three sizes; run scaling again");
            slopes.push_back(slope_of(points));
        }
        return median_of_rounds(slopes);
    }
    std::string renderer;

private:
    CsvTable t_;
};

/// memory.csv: the slope of what OpenGL holds over parameters, kind by kind, and least and largest side of maps.
struct MemoryLines {
    std::map<std::string, double> slopes;
    double least_side = HUGE_VAL, largest_side = 0;

    explicit MemoryLines(const CsvTable& t) {
        std::map<std::string, std::map<double, double>> lines;
        for (size_t i = 0; i < t.row_count(); ++i) {
            lines[fmt::format("{} passes, {}", t.text(i, "passes"), t.text(i, "storage"))][t.number(i, "parameters")] =
                t.number(i, "opengl_bytes");
            least_side = std::min(least_side, t.number(i, "side"));
            largest_side = std::max(largest_side, t.number(i, "side"));
        }
        for (const auto& [name, points] : lines) {
            if (points.size() < 3) throw UserError("memory.csv: a slope needs three sizes; run scaling again");
            slopes[name] = slope_of(points);
        }
        if (slopes.empty()) throw UserError("memory.csv: no rows; run scaling again");
    }
    double least() const { return by_value(std::ranges::min_element).second; }
    double largest() const { return by_value(std::ranges::max_element).second; }

private:
    std::pair<std::string, double> by_value(const auto& choose) const {
        return *choose(slopes, {}, [](const auto& s) { return s.second; });
    }
};

/// By what the paper's passes declare, of iterations with distribution over those with samples kept; in words.
std::vector<std::string> declared_redistribution(const FinishedRun& run, Evidence& e) {
    std::vector<std::string> found;
    const auto need = [&](bool told, const char* what) {
        e.premise("declared work", told, fmt::format("declared work{}, which this run's version did not count", what));
        return told;
    };
    if (!run.has_table("work.csv")) return need(false, ""), found;
    const CsvTable work = run.table("work.csv");
    if (!need(std::ranges::count(work.header(), "images") > 0, " of all images")) return found;
    for (const std::string optimizer : optimizers) {
        const auto of = [&](const char* what, const char* column) {
            const Where where{{"engine", paper}, {"what", what}, {"optimizer", optimizer}};
            return work.number(rows_where(work, where).front(), column);
        };
        const double operations = of(iteration, "operations") / of(kept, "operations"),
                     reads = of(iteration, "reads") / of(kept, "reads");
        const auto add = [&](const char* of, double ratio) {
            constexpr double computing = 0.3;  // the rest of SD's 20 % streaming and 50 % switching
            e.measure(of, fmt::format("{}, {} with distribution over those without", upper(optimizer), of),
                      exact(ratio), "times");
            e.measure(fmt::format("iteration bound by {}", of),
                      fmt::format("{}, an iteration of which {} take 30 %", upper(optimizer), of),
                      exact(1 / (1 - computing * (1 - 1 / ratio))), "times");
        };
        add("operations", operations);
        add("texture reads", reads);
        found.push_back(fmt::format("of {:.3g} times the operations and {:.3g} times the texture reads ({})",
                                    operations, reads, upper(optimizer)));
    }
    return found;
}

Evidence redistribution(const FinishedRun& run) {
    const Times times(run);
    Evidence e{.renderer = times.renderer};
    const auto only = [](const std::map<double, double>& points) { return points.begin()->second; };
    const auto quotients = [&](const std::string& engine, const char* above, const char* below) {
        const auto a = times.rounds("distribution", engine, "images", above),
                   b = times.rounds("distribution", engine, "images", below);
        std::vector<double> out;
        for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) out.push_back(only(a[i]) / only(b[i]));
        return out;
    };
    std::vector<std::string> found;
    for (const std::string& engine : {paper, compute_gather, compute_scatter}) {
        if (!times.has("distribution", engine)) continue;  // rows of a run without compute shaders
        const Figure figure = median_of_rounds(quotients(engine, iteration, kept));
        e.measure("time", plain_name(engine) + ", time with distribution over time without", figure, "times");
        found.push_back(with_interval(figure));
    }
    std::vector<double> on_cpu = quotients(cpu, distribution, iteration);
    for (double& x : on_cpu) x += 1;
    const Figure beside = median_of_rounds(on_cpu);
    e.beside.push_back(fmt::format(
        "on the CPU, an iteration over samples in memory and one distribution of all images take {} times as long as "
        "the iteration alone",
        with_interval(beside)));
    e.beside.push_back(
        "without: of the paper's passes, what every texel takes of each image was kept on the device by an earlier "
        "sweep, with images kept there in both cases; the rest of the passes is the same, and so are the results, to "
        "the bit. Compute shaders read a list of samples then, in an order of their own");
    const std::string in_compute =
        found.size() == 3
            ? fmt::format(", and in compute shaders that gather {} and that scatter {}", found[1], found[2])
            : "";
    e.premise_graphics_chip();
    const std::vector<std::string> declared = declared_redistribution(run, e);
    e.sentence = fmt::format(
        "{}In OpenGL, finding again in each sweep which pixel every surface texel takes makes an iteration {} times as "
        "long as with those samples kept{}; on the CPU, {:.3g} times.",
        declared.empty() ? ""
                         : fmt::format("By what its passes declare, finding again in each sweep which pixel every "
                                       "surface texel takes makes an iteration {}. ",
                                       fmt::join(declared, " and ")),
        found[0], in_compute, beside.value);
    return e;
}

Evidence memory_linear(const FinishedRun& run) {
    const CsvTable t = run.table("memory.csv");
    const MemoryLines lines(t);
    Evidence e{.renderer = Times(run).renderer};
    double worst = 0, layout = std::nan(""), layout_side = 0, held = std::nan("");
    double process_least = HUGE_VAL, process_most = 0;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const double planned = t.number(i, "planned_bytes");
        worst = std::max(worst, t.number(i, "opengl_bytes") / planned);
        if (t.number(i, "side") == 8) layout = t.number(i, "paper_layout_bytes"), layout_side = 8;
        if (t.number(i, "side") == 8 && t.text(i, "storage") == "fp32" && t.text(i, "passes") == "paper")
            held = t.number(i, "opengl_bytes");
        if (t.text(i, "process_bytes").empty()) continue;
        process_least = std::min(process_least, t.number(i, "process_bytes") / planned);
        process_most = std::max(process_most, t.number(i, "process_bytes") / planned);
    }
    e.measure("held over planned", "the most that OpenGL holds over what was planned", exact(worst), "times");
    for (const auto& [name, slope] : lines.slopes)
        e.measure("slope", name + ", slope of bytes over parameters", exact(slope));
    const double triangles = t.number(0, "triangles"), vertices = t.number(0, "vertices");
    const bool of_the_paper = std::abs(triangles / 6093 - 1) <= 0.01 && layout_side == 8;
    e.premise("the paper's star", of_the_paper,
              fmt::format("a star of 6,093 triangles with maps of 8 x 8, not of {:.0f} triangles", triangles));
    if (of_the_paper) e.measure("layout", "the paper's layout of its star", exact(layout / 1e6), "MB");
    e.premise("sides", lines.least_side <= 8 && lines.largest_side >= 32, "maps of sides from 8 to 32");
    e.beside.push_back(
        "what OpenGL holds: the sum over all its textures and buffers of the sizes and formats that the driver tells "
        "of each; padding of the driver's own it does not tell");
    if (process_most > 0)
        e.beside.push_back(fmt::format(
            "where OpenGL runs in the process, its resident memory grew by {:.3g} to {:.3g} of what was planned, "
            "compiled shaders included",
            process_least, process_most));
    const std::string layout_text =
        of_the_paper ? fmt::format(
                           ". The paper's 142 MB are not judged: one accounting of Section 6.3's is consistent with "
                           "them, {:.1f} MB for {:.0f} triangles and {:.0f} vertices, and our engine holds {:.3g} MB",
                           layout / 1e6, triangles, vertices, held / 1e6)
                     : "";
    e.sentence = fmt::format(
        "From maps of side {:g} to {:g} memory grows as the number of parameters to the power {:.3g} to {:.3g}, "
        "and is {:.3g} times what was planned at most{}.",
        lines.least_side, lines.largest_side, lines.least(), lines.largest(), worst, layout_text);
    return e;
}

Evidence gather_and_scatter(const FinishedRun& run) {
    const Times times(run);
    Evidence e{.renderer = times.renderer};
    if (!times.has_column("sweep_seconds"))
        throw UserError("time.csv: the time of sweeps is not told apart; run scaling again");
    std::vector<std::string> swept, whole;
    for (const std::string& engine : {paper, combined, compute_scatter}) {
        const std::string way = engine == compute_scatter ? "scatter" : "gather";
        const Figure sweeps = times.slope("texels", engine, "texels", "sweep_seconds"),
                     iterations = times.slope("texels", engine, "texels");
        const std::string of = way + ", " + plain_name(engine);
        e.measure(way + ", iterations", of + ", whole iterations", iterations);
        e.measure(way + ", sweeps", of + ", sweeps", sweeps);
        swept.push_back(with_interval(sweeps));
        whole.push_back(with_interval(iterations));
    }
    const auto rounds = times.rounds("texels", paper, "texels");
    const double factor = rounds.front().rbegin()->first / rounds.front().begin()->first;
    e.premise("a factor of 10", factor >= 10, "texels over a factor of 10 at least");
    std::vector<std::string> seconds;  // of sweeps, at the fewest and the most texels
    double last_power = 0;             // of the last one's, between the two largest sizes
    for (const std::string& engine : {compute_gather, compute_scatter}) {
        std::vector<double> first, last, powers;
        for (const auto& points : times.rounds("texels", engine, "texels", iteration, "sweep_seconds")) {
            const auto end = std::prev(points.end()), before = std::prev(end);
            first.push_back(points.begin()->second), last.push_back(end->second);
            powers.push_back(log_slope({*before, *end}));
        }
        seconds.push_back(fmt::format("{:.3g} to {:.3g} s", median(first), median(last)));
        last_power = median(powers);
    }
    e.beside.push_back(fmt::format(
        "compute shaders that gather, texel by texel, and distribute in every sweep, too: {}; the CPU, which walks "
        "through samples in memory, whole iterations: {}",
        with_interval(times.slope("texels", compute_gather, "texels", "sweep_seconds")),
        with_interval(times.slope("texels", cpu, "texels"))));
    e.beside.push_back(
        "the number of samples itself grows with that of texels, for more of the pixels find one, and with it what "
        "pixels scatter");
    e.sentence = fmt::format(
        "With gathers alone, the time of an iteration over the same images grows as the number of surface texels to "
        "the power {} with the paper's passes and {} with combined passes ({:.3g} times as many texels); where compute "
        "shaders scatter, pixel by pixel, to the power {}. Of sweeps over the images alone, without the optimizer's "
        "update of every texel, the powers are {}, {} and {}, scatter's between the two largest sizes {:.2g}; from the "
        "fewest to the most texels they take {} by compute shaders that scatter, and {} by those that gather.",
        whole[0], whole[1], factor, whole[2], swept[0], swept[1], swept[2], last_power, seconds[1], seconds[0]);
    return e;
}

/// How well time = a + b size fits a round, by least squares of relative errors.
struct Line {
    double misfit;  ///< the largest error, over the time there
    double share;   ///< of b size in the time at the largest size; below 0 where time falls

    explicit Line(const std::map<double, double>& points) {
        double w = 0, wx = 0, wxx = 0, wy = 0, wxy = 0;
        for (const auto& [x, y] : points) {
            const double weight = 1 / (y * y);
            w += weight, wx += weight * x, wxx += weight * x * x, wy += weight * y, wxy += weight * x * y;
        }
        const double b = (w * wxy - wx * wy) / (w * wxx - wx * wx), a = (wy - b * wx) / w;
        misfit = 0;
        for (const auto& [x, y] : points) misfit = std::max(misfit, std::abs(a + b * x - y) / y);
        share = b * points.rbegin()->first / points.rbegin()->second;
    }
};

/// How far from a line the medians of the rounds lie: one round's noise is no departure from it. The interval is by
/// bootstrap over whole rounds.
Figure misfit_of_medians(const std::vector<std::map<double, double>>& rounds) {
    const auto misfit = [&](const auto& drawn) {
        std::map<double, std::vector<double>> by_size;
        for (const size_t round : drawn)
            for (const auto& [size, seconds] : rounds[round]) by_size[size].push_back(seconds);
        std::map<double, double> medians;
        for (const auto& [size, seconds] : by_size) medians[size] = median(seconds);
        return Line(medians).misfit;
    };
    Figure out{misfit(std::views::iota(size_t(0), rounds.size()))};
    if (rounds.size() < least_rounds) return out;
    out.interval = bootstrap_interval([&, drawn = std::vector<size_t>(rounds.size())](Rng& rng) mutable {
        for (size_t& round : drawn) round = rng.index(uint32_t(rounds.size()));
        return misfit(drawn);
    });
    return out;
}

Evidence cost_linear(const FinishedRun& run) {
    const Times times(run);
    Evidence e{.renderer = times.renderer};
    std::vector<std::string> found;
    size_t sizes = SIZE_MAX;
    double factor = HUGE_VAL;
    for (const std::string& engine : {cpu, paper, combined}) {
        const auto all = times.rounds("samples", engine, "samples");
        sizes = std::min(sizes, all.front().size());
        factor = std::min(factor, all.front().rbegin()->first / all.front().begin()->first);
        std::vector<double> shares, last;
        for (const auto& points : all) {
            shares.push_back(Line(points).share);
            const auto end = std::prev(points.end()), before = std::prev(end);
            last.push_back(std::log(end->second / before->second) / std::log(end->first / before->first));
        }
        const Figure misfit = misfit_of_medians(all);
        const Figure share = median_of_rounds(shares), slope = times.slope("samples", engine, "samples");
        e.measure("off the line", plain_name(engine) + ", the farthest of the medians from a + b S", misfit, "%");
        e.measure("share of S", plain_name(engine) + ", b S at the most samples", share, "%");
        e.measure("slope of time", plain_name(engine) + ", slope of time over samples", slope);
        found.push_back(fmt::format("{} off at most, {} of the time by samples at the most of them ({})",
                                    percent(misfit.value), percent(share.value), plain_name(engine)));
        e.beside.push_back(fmt::format("{}: slope of logarithms {}, between the two largest sizes {:.3g}",
                                       plain_name(engine), with_interval(slope), median(last)));
    }
    const MemoryLines lines(run.table("memory.csv"));
    e.measure("memory", "largest slope of memory over parameters", exact(lines.largest()));
    e.premise("5 sizes over a factor of 16", sizes >= 5 && factor >= 16,
              fmt::format("at least 5 numbers of samples over a factor of 16, not {} over {:.3g}", sizes, factor));
    e.beside.push_back(
        "every image counts once: smaller sizes are fewer images of the same dataset; a is what every iteration costs "
        "by parameters");
    e.sentence = fmt::format(
        "Over {:.3g} times as many radiance samples S, an iteration's time is a + b S, {}; memory grows as the number "
        "of parameters to the power {:.3g} at most.",
        factor, fmt::join(found, ", "), lines.largest());
    return e;
}

}  // namespace

std::span<const ClaimCode> scale_claims() {
    static constexpr ClaimCode table[] = {
        {"C13", redistribution}, {"C14", memory_linear}, {"C15", gather_and_scatter}, {"C18", cost_linear}};
    return table;
}

}  // namespace radiafit::harness
