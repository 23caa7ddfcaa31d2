#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"
#include "experiment.h"
#include "rules.h"

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

Judgement redistribution(const FinishedRun& run) {
    const Times times(run);
    Judgement j{.renderer = times.renderer};
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
        j.measures.push_back({.of = plain_name(engine) + ", time with distribution over time without",
                              .figure = figure,
                              .bound = at_most(1.1)});
        found.push_back(with_interval(figure));
    }
    std::vector<double> on_cpu = quotients(cpu, distribution, iteration);
    for (double& x : on_cpu) x += 1;
    const Figure beside = median_of_rounds(on_cpu);
    j.beside.push_back(fmt::format(
        "on the CPU, an iteration over samples in memory and one distribution of all images take {} times as long as "
        "the iteration alone",
        with_interval(beside)));
    j.beside.push_back(
        "without: of the paper's passes, what every texel takes of each image was kept on the device by an earlier "
        "sweep, with images kept there in both cases; the rest of the passes is the same, and so are the results, to "
        "the bit. Compute shaders read a list of samples then, in an order of their own");
    const std::string in_compute =
        found.size() == 3
            ? fmt::format(", and in compute shaders that gather {} and that scatter {}", found[1], found[2])
            : "";
    j.sentence = fmt::format(
        "In OpenGL, finding again in each sweep which pixel every surface texel takes makes an iteration {} times as "
        "long as with those samples kept{}; on the CPU, {:.3g} times.",
        found[0], in_compute, beside.value);
    j.demand_graphics_chip();
    return j;
}

Judgement memory_linear(const FinishedRun& run) {
    const CsvTable t = run.table("memory.csv");
    const MemoryLines lines(t);
    Judgement j{.renderer = Times(run).renderer};
    double worst = 0, layout = std::nan(""), layout_side = 0;
    double process_least = HUGE_VAL, process_most = 0;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const double planned = t.number(i, "planned_bytes");
        worst = std::max(worst, t.number(i, "opengl_bytes") / planned);
        if (t.number(i, "side") == 8) layout = t.number(i, "paper_layout_bytes"), layout_side = 8;
        if (t.text(i, "process_bytes").empty()) continue;
        process_least = std::min(process_least, t.number(i, "process_bytes") / planned);
        process_most = std::max(process_most, t.number(i, "process_bytes") / planned);
    }
    j.measures.push_back(
        {.of = "the most that OpenGL holds over what was planned", .figure = exact(worst), .bound = at_most(1.05)});
    for (const auto& [name, slope] : lines.slopes)
        j.measures.push_back(
            {.of = name + ", slope of bytes over parameters", .figure = exact(slope), .bound = at_most(1.05)});
    const double triangles = t.number(0, "triangles"), vertices = t.number(0, "vertices");
    const bool of_the_paper = std::abs(triangles / 6093 - 1) <= 0.01 && layout_side == 8;
    j.demand(of_the_paper,
             fmt::format("a star of 6,093 triangles with maps of 8 x 8, not of {:.0f} triangles", triangles));
    if (of_the_paper)
        j.measures.push_back({.of = "the paper's layout of its star",
                              .figure = exact(layout / 1e6),
                              .bound = between(0.95 * 142, 1.05 * 142),
                              .unit = "MB"});
    j.demand(lines.least_side <= 8 && lines.largest_side >= 32, "maps of sides from 8 to 32");
    j.beside.push_back(
        "what OpenGL holds: the sum over all its textures and buffers of the sizes and formats that the driver tells "
        "of each; padding of the driver's own it does not tell");
    if (process_most > 0)
        j.beside.push_back(fmt::format(
            "where OpenGL runs in the process, its resident memory grew by {:.3g} to {:.3g} of what was planned, "
            "compiled shaders included",
            process_least, process_most));
    const std::string layout_text =
        of_the_paper ? fmt::format(
                           "; the paper's own layout comes to {:.1f} MB for {:.0f} triangles and {:.0f} "
                           "vertices, where it states 142 MB",
                           layout / 1e6, triangles, vertices)
                     : "";
    j.sentence = fmt::format(
        "From maps of side {:g} to {:g} memory grows as the number of parameters to the power {:.3g} to {:.3g}, "
        "and is {:.3g} times what was planned at most{}.",
        lines.least_side, lines.largest_side, lines.least(), lines.largest(), worst, layout_text);
    return j;
}

Judgement gather_and_scatter(const FinishedRun& run) {
    const Times times(run);
    Judgement j{.renderer = times.renderer};
    if (!times.has_column("sweep_seconds"))
        throw UserError("time.csv: the time of sweeps is not told apart; run scaling again");
    std::vector<std::string> swept, whole;
    for (const std::string& engine : {paper, combined, compute_scatter}) {
        const bool scatters = engine == compute_scatter;
        const Figure slope = times.slope("texels", engine, "texels", "sweep_seconds");
        j.measures.push_back({.of = (scatters ? "scatter, " : "gather, ") + plain_name(engine),
                              .figure = slope,
                              .bound = scatters ? at_most(0.2) : at_least(0.5)});
        swept.push_back(with_interval(slope));
        whole.push_back(with_interval(times.slope("texels", engine, "texels")));
    }
    const auto rounds = times.rounds("texels", paper, "texels");
    const double factor = rounds.front().rbegin()->first / rounds.front().begin()->first;
    j.demand(factor >= 10, "texels over a factor of 10 at least");
    j.beside.push_back(fmt::format(
        "sweeps over the images are what is timed; of whole iterations, whose optimizer updates every texel once, "
        "however many images there are, the powers are {} with the paper's passes, {} with combined passes and {} with "
        "compute shaders that scatter",
        whole[0], whole[1], whole[2]));
    j.beside.push_back(fmt::format(
        "compute shaders that gather, texel by texel, and distribute in every sweep, too: {}; the CPU, which walks "
        "through samples in memory, whole iterations: {}",
        with_interval(times.slope("texels", compute_gather, "texels", "sweep_seconds")),
        with_interval(times.slope("texels", cpu, "texels"))));
    j.beside.push_back(
        "the number of samples itself grows with that of texels, for more of the pixels find one, and with it what "
        "pixels scatter");
    j.sentence = fmt::format(
        "With gathers alone, the time of sweeps over the same images grows as the number of surface texels to the "
        "power "
        "{} with the paper's passes and {} with combined passes ({:.3g} times as many texels); where compute shaders "
        "scatter, pixel by pixel, to the power {}.",
        swept[0], swept[1], factor, swept[2]);
    return j;
}

/// How pixels reach texels, from table1_datasets' rows of one dataset and way to choose sides.
struct Reached {
    double texels_per_pixel;  ///< that face the camera, in the median image
    double dropped;           ///< share of pixels that no texel takes
    double middle;            ///< the median texel's samples
    double without, few;      ///< shares of texels: with none, and with fewer than 10
};

Reached reached(const FinishedRun& run, const std::string& files) {
    const CsvTable images = run.table(files + "_images.csv"), histogram = run.table(files + "_samples_per_texel.csv");
    std::vector<double> density;
    double covered = 0, kept = 0;
    for (size_t k = 0; k < images.row_count(); ++k) {
        covered += images.number(k, "covered_pixels");
        kept += images.number(k, "kept_pixels");
        if (images.number(k, "covered_pixels") > 0)
            density.push_back(images.number(k, "facing_texels") / images.number(k, "covered_pixels"));
    }
    double texels = 0, without = 0, few = 0;
    for (size_t k = 0; k < histogram.row_count(); ++k) {
        const double samples = histogram.number(k, "samples"), count = histogram.number(k, "texels");
        texels += count;
        without += samples == 0 ? count : 0;
        few += samples < 10 ? count : 0;
    }
    double up_to = 0, middle = 0;
    for (size_t k = 0; k < histogram.row_count() && up_to < 0.5 * texels; ++k) {
        up_to += histogram.number(k, "texels");
        middle = histogram.number(k, "samples");
    }
    return {median(density), 1 - kept / covered, middle, without / texels, few / texels};
}

Judgement pixels_and_texels(const FinishedRun& run) {
    const CsvTable t = run.table("datasets.csv");
    Judgement j;
    std::set<std::string> names;
    std::vector<std::string> found;
    double shared_texels = 0;
    for (size_t i = 0; i < t.row_count(); ++i) {
        const std::string& name = t.text(i, "dataset");
        const bool own = t.text(i, "sides") == "own";
        const double shared = t.number(i, "shared_texels");
        const Reached r = reached(run, name + (own ? "_own_sides" : ""));
        j.beside.push_back(fmt::format(
            "{}, {}: {:.3g} texels per covered pixel in the median image, {:g} samples in the median texel; {:.1f} % "
            "of "
            "the pixels are dropped, because no texel takes them; {:.1f} % of the texels have no sample, {:.1f} % "
            "fewer than 10",
            name, own ? "sides by projected size" : "one side for all", r.texels_per_pixel, r.middle, 100 * r.dropped,
            100 * r.without, 100 * r.few));
        if (!own) continue;
        names.insert(name);
        shared_texels += shared;
        j.demand(r.texels_per_pixel >= 1,
                 fmt::format("surfaces with a texel for each covered pixel at least; {} has {:.3g}", name,
                             r.texels_per_pixel));
        j.measures.push_back(
            {.of = name + ", samples of the median texel", .figure = exact(r.middle), .bound = at_least(10)});
        j.measures.push_back(
            {.of = name + ", texels that took two pixels of one image", .figure = exact(shared), .bound = at_most(0)});
        found.push_back(fmt::format("{:g} on the {} ({:.2f} texels per pixel)", r.middle, name, r.texels_per_pixel));
    }
    j.demand(names.contains("star") && names.contains("bust"), "star and bust, with surface maps of their own sides");
    j.sentence = fmt::format(
        "With surface maps as large as their triangles in photographs, {} texel takes two pixels of one image, and the "
        "median texel gets as many samples over all images as: {}.",
        shared_texels > 0 ? "some" : "no", fmt::join(found, ", "));
    return j;
}

Judgement cost_linear(const FinishedRun& run) {
    const Times times(run);
    Judgement j{.renderer = times.renderer};
    std::vector<std::string> found;
    size_t sizes = SIZE_MAX;
    double factor = HUGE_VAL;
    for (const std::string& engine : {cpu, paper, combined}) {
        const auto points = times.rounds("samples", engine, "samples").front();
        sizes = std::min(sizes, points.size());
        factor = std::min(factor, points.rbegin()->first / points.begin()->first);
        const Figure slope = times.slope("samples", engine, "samples");
        j.measures.push_back(
            {.of = plain_name(engine) + ", slope of time over samples", .figure = slope, .bound = at_most(1.1)});
        found.push_back(fmt::format("{} ({})", with_interval(slope), plain_name(engine)));
    }
    const MemoryLines lines(run.table("memory.csv"));
    j.measures.push_back(
        {.of = "largest slope of memory over parameters", .figure = exact(lines.largest()), .bound = at_most(1.1)});
    j.demand(sizes >= 5 && factor >= 16,
             fmt::format("at least 5 numbers of samples over a factor of 16, not {} over {:.3g}", sizes, factor));
    j.beside.push_back(
        "every image counts once: smaller sizes are fewer images of the same dataset; a part of every iteration costs "
        "by parameters, and makes slopes smaller than 1");
    j.sentence = fmt::format(
        "Over {:.3g} times as many radiance samples, an iteration's time grows as their number to the power {}; memory "
        "as the number of parameters to the power {:.3g} at most.",
        factor, fmt::join(found, ", "), lines.largest());
    return j;
}

}  // namespace

std::span<const Claim> scale_claims() {
    static constexpr Claim table[] = {
        {"C13", "4.3", "redistributing every iteration costs almost nothing",
         "time of an iteration that distributes in each sweep over that with samples kept on the device, in OpenGL "
         "without streaming, by the paper's passes and in compute shaders that gather and that scatter, is at most 1.1",
         "scaling", redistribution},
        {"C14", "6.3", "memory is O(N); 142 MB for the star at 32 bits",
         "the bytes of all textures and buffers, as OpenGL tells them, exceed the plan by at most 5 %; slope of log "
         "bytes over log parameters at most 1.05, sides 8 to 32; the paper's layout for the star within 5 % of 142 MB",
         "scaling", memory_linear},
        {"C15", "6.6", "limited scatter and gather would remove the dependence on the sampling rate",
         "slope of log time of sweeps over log texels at fixed images: gather in fragment programs at least 0.5, "
         "scatter in compute shaders at most 0.2",
         "scaling", gather_and_scatter},
        {"C17", "5.1.1", "a pixel lands in one texel, and every parameter still gets many samples",
         "with surface maps of sides by their triangles' projected size, where the median image has at least one "
         "texel that faces it per covered pixel: no texel takes two pixels of one image, and the median texel has at "
         "least 10 samples",
         "table1_datasets", pixels_and_texels},
        {"C18", "3.2", "an iteration costs O(S), memory O(N)",
         "slope of log time over log samples at most 1.1, on the CPU and in OpenGL, at least 5 sizes over a factor of "
         "16, distinct images; slope of log bytes over log parameters at most 1.1",
         "scaling", cost_linear},
    };
    return table;
}

}  // namespace radiafit::harness
