// Lafortune's reflectance model (Sections 4.2 and 6.5): every solver on the same samples of the ornament, against its
// truth and against Ceres, texel by texel, and against held-out images. White, which is made by another model, has no
// truth that parameters could be compared with.
#include "rows/reflectance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/atomic_file.h"
#include "base/instructions.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "dataset/truth.h"
#include "eval/judge.h"
#include "eval/reflectance_renderer.h"
#include "eval/truth_errors.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "report/csv.h"
#include "report/csv_file.h"
#include "report/table.h"
#include "texel_arrival.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::reflectance;

constexpr const char* fitted_model = "lafortune";
constexpr Range<double> exponents{0, 1e6}, distances{0, 1e6};

struct Options {
    double read_noise = 0.002, shot_noise = 0.01;
    int lm_iterations = 50, cg_iterations = 50, sd_iterations = 250, fragment_iterations = 25;
    double sharp = 15, within = 1.05, recovered = 1e-3;
    std::vector<int> arrival_newton = {2, 4, 8, 20}, arrival_gradient = {10, 40, 100};
    ArrivalOptions arrival;

    explicit Options(Config& c) {
        c.read("read_noise", read_noise, limits::noise);
        c.read("shot_noise", shot_noise, limits::noise);
        c.read("lm_iterations", lm_iterations, limits::some_iterations);
        c.read("cg_iterations", cg_iterations, limits::some_iterations);
        c.read("sd_iterations", sd_iterations, limits::some_iterations);
        c.read("fragment_iterations", fragment_iterations, limits::iterations);
        c.read("sharp", sharp, exponents);
        c.read("within", within, limits::tolerance);
        c.read("recovered", recovered, distances);
        c.read("arrival_blocks", arrival.every, limits::repetitions);
        c.read("arrival_newton", arrival_newton, limits::some_iterations);
        c.read("arrival_gradient", arrival_gradient, limits::some_iterations);
        c.read("arrival_repetitions", arrival.repetitions, limits::repetitions);
        c.finish();
    }
};

struct Entrant {
    std::string name;
    FitRequest request;
};

/// A fit of Lafortune's model.
FitRequest request_of(const char* solver, const char* optimizer, const char* mode, int iterations, int side) {
    FitRequest r;
    r.set("model", fitted_model);
    r.solver = solver;
    r.set("optimizer", optimizer);
    r.set("mode", mode);
    r.iterations = iterations;
    r.model.surface_side = side;
    return r;
}

/// OpenGL on noisy images alone, for its time; it distributes by itself, so some of its samples are others.
std::vector<Entrant> entrants_of(const Options& o, int side, bool noisy) {
    std::vector<Entrant> out;
    out.push_back({"Ceres", request_of("ceres", "cg", "modern", o.lm_iterations, side)});
    out.push_back({"Ceres varpro", request_of("ceres-varpro", "cg", "modern", o.lm_iterations, side)});
    out.push_back({"TinySolver", request_of("tinysolver", "cg", "modern", o.lm_iterations, side)});
    out.push_back({"TinySolver in floats", request_of("tinysolver-float", "cg", "modern", o.lm_iterations, side)});
    out.push_back({"LM", request_of("stream", "lm", "modern", o.lm_iterations, side)});
    out.push_back({"Lambertian", request_of("stream", "lm", "modern", o.lm_iterations, side)});
    out.back().request.set("model", "lambert");
    for (const NamedRule& ours : named_rules())
        out.push_back({ours.name, request_of("stream", ours.method->name, ours.mode,
                                             ours.method->lines ? o.cg_iterations : o.sd_iterations, side)});
    if (noisy && o.fragment_iterations > 0) {
        out.push_back({"cg modern OpenGL", request_of("stream", "cg", "modern", o.fragment_iterations, side)});
        out.back().request.set("engine", "fragment");
    }
    return out;
}

/// The same methods on their way, but for the Lambertian model and OpenGL.
std::vector<Climber> climbers_of(const Options& o, int side) {
    constexpr int lanes = 8;
    const char *base = compiled_instructions(), *widest = widest_instructions();
    const auto newton = [&](const char* solver) { return request_of(solver, "cg", "modern", 1, side); };
    const FitRequest lm = request_of("stream", "lm", "modern", 1, side);
    std::vector<Climber> out;
    out.push_back({"LM", lm, o.arrival_newton, {in_32, lanes, widest}});
    if (std::string_view(base) != widest)
        out.push_back({fmt::format("LM, {}", base), lm, o.arrival_newton, {in_32, lanes, base}, true});
    out.push_back({"TinySolver in floats", newton("tinysolver-float"), o.arrival_newton, {"32", 1, base}});
    out.push_back({"TinySolver", newton("tinysolver"), o.arrival_newton, {"64", 1, base}});
    out.push_back({"Ceres", newton("ceres"), o.arrival_newton, {"64", 1, ceres_instructions()}});
    out.push_back({"Ceres varpro", newton("ceres-varpro"), o.arrival_newton, {"64", 1, ceres_instructions()}});
    for (const NamedRule& ours : named_rules())
        out.push_back({ours.name,
                       request_of("stream", ours.method->name, ours.mode, 1, side),
                       o.arrival_gradient,
                       {in_32, lanes, widest}});
    return out;
}

/// Parts of the surface by what is true of them.
struct Group {
    std::string name;
    std::vector<uint32_t> texels;
};

double exponent(const ReflectanceTruth& truth, size_t texel) { return double(truth.parameters[texel][8]); }

/// Every material; and of those that the fitted model made, the texels by their lobes.
std::vector<Group> groups_of(const ReflectanceTruth& truth, const Options& o) {
    std::vector<Group> out;
    for (const TruthMaterial& material : truth.materials) out.push_back({material.name, {}});
    Group moderate{"moderate lobes", {}}, sharp{"sharp lobes", {}};
    for (uint32_t t = 0; t < truth.material.size(); ++t) {
        out[truth.material[t]].texels.push_back(t);
        if (truth.materials[truth.material[t]].model == fitted_model)
            (exponent(truth, t) < o.sharp ? moderate : sharp).texels.push_back(t);
    }
    out.push_back(std::move(moderate));
    out.push_back(std::move(sharp));
    return out;
}

/// Of samples in [0, 1]: errors below are rounding.
constexpr double least_rms = 1e-4;

struct Verdict {
    size_t texels = 0;
    double within = 0, rms = 0, iterations = 0;
    std::optional<double> worst_median = {}, recovered = {};  ///< of texels whose truth is of the fitted model
};
Verdict compare(const Group& group, const ReflectanceFit& fit, const ReflectanceFit& ceres,
                const ReflectanceTruth& truth, const Options& o) {
    Verdict out;
    std::vector<double> worst, iterations;
    double squares = 0, samples = 0;
    std::vector<TruthComparison> comparisons;
    for (const TruthMaterial& material : truth.materials) comparisons.emplace_back(*fit.options.model, material);
    for (const uint32_t t : group.texels) {
        // what every method was given: distributors may differ in some pixels
        if (fit.samples[t] < o.arrival.least_samples || ceres.samples[t] < o.arrival.least_samples) continue;
        const TruthComparison& comparison = comparisons[truth.material[t]];
        if (comparison.possible()) worst.push_back(comparison.worst({&fit.parameters[9 * t], 9}, truth.parameters[t]));
        iterations.push_back(fit.iterations[t]);
        const auto rms = [&](const ReflectanceFit& f) {
            return std::sqrt(2 * double(f.error[t]) / (3.0 * f.samples[t]));
        };
        out.within += rms(fit) <= std::max(o.within * rms(ceres), least_rms);
        squares += 2 * double(fit.error[t]);
        samples += 3.0 * fit.samples[t];
    }
    out.rms = std::sqrt(squares / samples);
    out.texels = iterations.size();
    out.within /= double(out.texels);
    if (!worst.empty()) {
        const auto recovered = std::ranges::count_if(worst, [&](double error) { return error < o.recovered; });
        out.recovered = double(recovered) / double(worst.size());
        out.worst_median = median(std::move(worst));
    }
    out.iterations = median(std::move(iterations));
    return out;
}

/// The error of held-out images: of the whole ornament and of each material, by name.
std::vector<PartFigures> image_errors(const ReflectanceOutcome& outcome, const Dataset& dataset,
                                      const ReflectanceTruth& truth) {
    const ReflectanceRenderer renderer(*outcome.atlas, outcome.fit);
    SurfaceParts parts;
    parts.of = [&](const RasterPixel& pixel) { return size_t(truth.material[renderer.texel_of(pixel)]); };
    for (const TruthMaterial& material : truth.materials) parts.names.push_back(material.name);
    JudgeResult judged =
        judge(contestant_of(outcome.fit, *outcome.atlas), dataset, Split::test, {.parts = &parts, .pixel_points = 1});
    judged.parts.insert(judged.parts.begin(), {"all", judged.stored});
    return std::move(judged.parts);
}

/// One kind of images of the ornament, and what is true of it.
struct Images {
    std::string name;  ///< "noisy"
    Dataset dataset;
    ReflectanceTruth truth;
    std::vector<Group> groups;
};

class Files {
public:
    explicit Files(const std::filesystem::path& folder)
        : folder_(folder),
          fits_(folder, rows::fits),
          // samples: those that count. solve_s: from samples at hand to parameters and their errors, the same work in
          // every row but OpenGL's: it reads images in load_s and distributes them in solve_s, both in every sweep,
          // where the others share one distribution, and load_s is reading its samples and shading them (Ceres': once
          // more for its errors).
          times_(folder, rows::times),
          pictures_(folder, rows::pictures),
          table_({"images", "method", "solve s", "fits/s", "gold within", "green within", "white within", "gold off by",
                  "green off by", "held-out PSNR"}) {}

    void add(const Images& images, const Entrant& entrant, const std::string& renderer,
             const ReflectanceOutcome& outcome, const ReflectanceFit& ceres, double distribution_s, const Options& o) {
        const bool streams = entrant.request.on_fragment_engine();
        const FitTimes& t = outcome.times;
        const double texels = double(outcome.fit.problem_count()), solve_s = t.optimization;
        const double ns = 1e9 * solve_s / double(std::max<uint64_t>(1, outcome.sample_iterations));
        uint64_t samples = 0;
        for (const uint32_t n : outcome.fit.samples) samples += n;
        times_.add({images.name, entrant.name, renderer, streams ? "every sweep" : "once", outcome.fit.problem_count(),
                    samples, streams ? 0 : distribution_s, t.streaming, solve_s, texels / solve_s, ns});
        std::map<std::string, Verdict> verdicts;
        for (const Group& group : images.groups) {
            const Verdict v = compare(group, outcome.fit, ceres, images.truth, o);
            verdicts.emplace(group.name, v);
            fits_.add({images.name, entrant.name, renderer, entrant.request.iterations, group.name, v.texels,
                       v.worst_median, v.recovered, v.within, v.rms, v.iterations});
        }
        const auto within = [&](const char* group) { return fmt::format("{:.2f} %", 100 * verdicts[group].within); };
        const auto off_by = [&](const char* group) {
            const std::optional<double>& worst = verdicts[group].worst_median;
            return worst ? fmt::format("{:.2g} %", 100 * *worst) : "";
        };
        table_.add({images.name, entrant.name, fmt::format("{:.2f}", solve_s), fmt::format("{:.0f}", texels / solve_s),
                    within("gold"), within("green"), within("white"), off_by("gold"), off_by("green"),
                    add_pictures(images, entrant.name, renderer, outcome)});
    }
    void commit() {
        fits_.commit();
        times_.commit();
        pictures_.commit();
        write_file(folder_ / "reflectance.md", table_.markdown());
        log_info(table_.text());
    }

private:
    /// Returns the whole ornament's PSNR.
    std::string add_pictures(const Images& images, const std::string& method, const std::string& renderer,
                             const ReflectanceOutcome& outcome) {
        const std::vector<PartFigures> parts = image_errors(outcome, images.dataset, images.truth);
        for (const PartFigures& part : parts)
            pictures_.add({images.name, method, renderer, part.name, part.stored.values / 3, part.stored.psnr(),
                           part.stored.ape()});
        return fmt::format("{:.2f} dB", parts.front().stored.psnr());
    }

    std::filesystem::path folder_;
    CsvFile<rows::Fit> fits_;
    CsvFile<rows::Time> times_;
    CsvFile<rows::Part> pictures_;
    Table table_;
};

void write_arrivals(const std::filesystem::path& folder, const std::vector<rows::Arrival>& arrivals) {
    CsvFile csv(folder, rows::arrivals);
    Table table({"method", "iterations", "arrived", "seconds"});
    for (const rows::Arrival& r : arrivals) {
        csv.add(r);
        table.add({r.method, std::to_string(r.iterations), fmt::format("{:.1f} %", 100 * r.arrived_share),
                   fmt::format("{:.3g}", r.seconds)});
    }
    csv.commit();
    log_info("texels within 1 % of the least error that any fit left them, on one thread\n" + table.text());
}

Images images_of(const Experiment& experiment, const Options& o, bool noisy) {
    OrnamentOptions ornament;
    if (noisy) {
        ornament.sensor.read_noise = float(o.read_noise);
        ornament.sensor.shot_noise = float(o.shot_noise);
    } else {
        ornament.sensor.encoding = Encoding::f32_linear;
    }
    Images images{.name = noisy ? "noisy" : "noise-free",
                  .dataset = experiment.dataset("ornament", ornament, noisy ? "noisy" : "exact"),
                  .truth = {},
                  .groups = {}};
    images.truth = read_truth(images.dataset.folder);
    images.groups = groups_of(images.truth, o);
    return images;
}

void reflectance(Experiment& experiment) {
    const Options o(experiment.config());
    const std::string cpu = experiment.cpu_name();
    std::string opengl;
    ResultFolder results = experiment.open_results(experiment.cpu_device());
    Files files(results.path());
    std::vector<rows::Arrival> arrivals;
    for (const bool noisy : {false, true}) {
        const Images images = images_of(experiment, o, noisy);
        const Dataset& dataset = images.dataset;
        const std::vector<Entrant> entrants = entrants_of(o, dataset.normal_map.side, noisy);
        const SharedTexels shared = distribute_texels(dataset, entrants.front().request, dataset.split(false));
        ReflectanceFit ceres;
        for (const Entrant& entrant : entrants) {
            log_info(fmt::format("{}, {} images", entrant.name, images.name));
            const ReflectanceOutcome outcome = solve_reflectance(dataset, entrant.request, {}, nullptr, &shared);
            if (&entrant == &entrants.front()) ceres = outcome.fit;
            if (!outcome.gl_renderer.empty()) note_gl(outcome, results.record());
            if (!outcome.gl_renderer.empty()) opengl = "; OpenGL: " + outcome.gl_renderer;
            files.add(images, entrant, outcome.gl_renderer.empty() ? cpu : outcome.gl_renderer, outcome, ceres,
                      shared.seconds, o);
        }
        if (noisy) arrivals = texel_arrivals(dataset, shared, climbers_of(o, dataset.normal_map.side), o.arrival);
    }
    files.commit();
    write_arrivals(results.path(), arrivals);
    experiment.finish(results,
                      fmt::format("ornament, {} scale; {}{}", experiment.profile(), experiment.cpu_device(), opengl));
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("reflectance", argc, argv, radiafit::harness::reflectance);
}
