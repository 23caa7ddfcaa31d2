// Lafortune's reflectance model (Sections 4.2 and 6.5): every solver on the same samples of the ornament, against its
// truth and against Ceres, texel by texel.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/limits.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "dataset/truth.h"
#include "eval/truth_errors.h"
#include "experiment.h"
#include "report/csv.h"
#include "report/table.h"

namespace radiafit {
namespace {

constexpr const char* fitted_model = "lafortune";
constexpr Range<double> exponents{0, 1e6}, distances{0, 1e6};

struct Options {
    double read_noise = 0.002, shot_noise = 0.01;
    int lm_iterations = 50, cg_iterations = 50, sd_iterations = 250, fragment_iterations = 25;
    double sharp = 15, within = 1.05, recovered = 1e-3;

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
        c.finish();
    }
};

struct Contestant {
    std::string name;
    FitRequest request;
    ReflectanceOutcome outcome = {};
};

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
std::vector<Contestant> contestants_of(const Options& o, int side, bool noisy) {
    std::vector<Contestant> out;
    out.push_back({"Ceres", request_of("ceres", "cg", "modern", o.lm_iterations, side)});
    out.push_back({"Ceres varpro", request_of("ceres-varpro", "cg", "modern", o.lm_iterations, side)});
    out.push_back({"TinySolver", request_of("tinysolver", "cg", "modern", o.lm_iterations, side)});
    out.push_back({"LM", request_of("stream", "lm", "modern", o.lm_iterations, side)});
    for (const NamedRule& ours : named_rules())
        out.push_back({ours.name, request_of("stream", ours.method->name, ours.mode,
                                             ours.method->lines ? o.cg_iterations : o.sd_iterations, side)});
    if (noisy && o.fragment_iterations > 0) {
        out.push_back({"cg modern OpenGL", request_of("stream", "cg", "modern", o.fragment_iterations, side)});
        out.back().request.set("engine", "fragment");
    }
    return out;
}

/// Parts of the surface by what is true of them.
struct Group {
    std::string name;
    std::vector<uint32_t> texels;
};

double exponent(const ReflectanceTruth& truth, size_t texel) { return double(truth.parameters[texel][8]); }

std::vector<Group> groups_of(const ReflectanceTruth& truth, const Options& o) {
    std::vector<Group> out = {{"gold", {}}, {"green", {}}, {"moderate lobes", {}}, {"sharp lobes", {}}};
    for (uint32_t t = 0; t < truth.material.size(); ++t) {
        const TruthMaterial& material = truth.materials[truth.material[t]];
        if (material.model != fitted_model) continue;
        for (Group& group : out)
            if (group.name == material.name) group.texels.push_back(t);
        out[exponent(truth, t) < o.sharp ? 2 : 3].texels.push_back(t);
    }
    return out;
}

/// Of samples in [0, 1]: errors below are rounding.
constexpr double least_rms = 1e-4;

struct Verdict {
    size_t texels = 0;
    double worst_median = 0, recovered = 0, within = 0, iterations = 0;
};
Verdict judge(const Group& group, const ReflectanceFit& fit, const ReflectanceFit& ceres, const ReflectanceTruth& truth,
              const Options& o) {
    Verdict out;
    std::vector<double> worst, iterations;
    std::vector<TruthComparison> comparisons;
    for (const TruthMaterial& material : truth.materials) comparisons.emplace_back(*fit.options.model, material);
    for (const uint32_t t : group.texels) {
        // what every contestant was given: distributors may differ in some pixels
        if (fit.samples[t] < 9 || ceres.samples[t] < 9) continue;
        worst.push_back(comparisons[truth.material[t]].worst({&fit.parameters[9 * t], 9}, truth.parameters[t]));
        iterations.push_back(fit.iterations[t]);
        const auto rms = [&](const ReflectanceFit& f) {
            return std::sqrt(2 * double(f.error[t]) / (3.0 * f.samples[t]));
        };
        out.within += rms(fit) <= std::max(o.within * rms(ceres), least_rms);
        out.recovered += worst.back() < o.recovered;
    }
    out.texels = worst.size();
    out.within /= double(out.texels);
    out.recovered /= double(out.texels);
    out.worst_median = median(std::move(worst));
    out.iterations = median(std::move(iterations));
    return out;
}

void reflectance(Experiment& experiment) {
    const Options o(experiment.config());
    const std::string cpu = experiment.cpu_name();
    std::string opengl;
    ResultFolder results = experiment.open_results(cpu);
    CsvWriter fits(results.path() / "fits.csv",
                   {"images", "method", "renderer", "iterations", "group", "texels", "worst_error_median",
                    "recovered_share", "within_share", "iterations_median"});
    // samples: those that count. solve_s: from samples at hand to parameters and their errors, the same work in every
    // row but OpenGL's: it reads images in load_s and distributes them in solve_s, both in every sweep, where the
    // others share one distribution, and load_s is reading its samples and shading them (Ceres': once more for its
    // errors).
    CsvWriter times(results.path() / "times.csv",
                    {"images", "method", "renderer", "distributes", "texels", "samples", "distribution_s", "load_s",
                     "solve_s", "fits_per_s", "ns_per_sample_iteration"});
    Table table(
        {"images", "method", "solve s", "fits/s", "moderate within", "sharp within", "gold off by", "green off by"});
    for (const bool noisy : {false, true}) {
        OrnamentOptions ornament;
        if (noisy) {
            ornament.sensor.read_noise = float(o.read_noise);
            ornament.sensor.shot_noise = float(o.shot_noise);
        } else {
            ornament.sensor.encoding = Encoding::f32_linear;
        }
        const Dataset dataset = experiment.dataset("ornament", ornament, noisy ? "noisy" : "exact");
        const ReflectanceTruth truth = read_truth(dataset.folder);
        const std::vector<Group> groups = groups_of(truth, o);
        const char* images = noisy ? "noisy" : "noise-free";
        std::vector<Contestant> contestants = contestants_of(o, dataset.normal_map.side, noisy);
        SharedTexels shared = distribute_texels(dataset, contestants.front().request, dataset.split(false));
        for (Contestant& m : contestants) {
            log_info(fmt::format("{}, {} images", m.name, images));
            m.outcome = solve_reflectance(dataset, m.request, {}, nullptr, &shared);
            if (!m.outcome.gl_renderer.empty()) note_gl(m.outcome, results.record());
            const std::string renderer = m.outcome.gl_renderer.empty() ? cpu : m.outcome.gl_renderer;
            if (!m.outcome.gl_renderer.empty()) opengl = "; OpenGL: " + renderer;
            const FitTimes& t = m.outcome.times;
            const double solve_s = t.optimization, texels = double(m.outcome.fit.problem_count());
            const bool streams = !m.outcome.gl_renderer.empty();
            uint64_t samples = 0;
            for (const uint32_t n : m.outcome.fit.samples) samples += n;
            const double ns = 1e9 * solve_s / double(std::max<uint64_t>(1, m.outcome.sample_iterations));
            times.row({images, m.name, renderer, streams ? "every sweep" : "once",
                       fmt::format("{}", m.outcome.fit.problem_count()), fmt::format("{}", samples),
                       fmt::format("{:.4g}", streams ? 0 : shared.seconds), fmt::format("{:.4g}", t.streaming),
                       fmt::format("{:.4g}", solve_s), fmt::format("{:.4g}", texels / solve_s),
                       fmt::format("{:.4g}", ns)});
            std::vector<Verdict> verdicts;
            for (const Group& group : groups) {
                const Verdict v = judge(group, m.outcome.fit, contestants.front().outcome.fit, truth, o);
                verdicts.push_back(v);
                fits.row({images, m.name, renderer, std::to_string(m.request.iterations), group.name,
                          fmt::format("{}", v.texels), fmt::format("{:.4g}", v.worst_median),
                          fmt::format("{:.5f}", v.recovered), fmt::format("{:.5f}", v.within),
                          fmt::format("{}", v.iterations)});
            }
            table.add({images, m.name, fmt::format("{:.2f}", solve_s), fmt::format("{:.0f}", texels / solve_s),
                       fmt::format("{:.2f} %", 100 * verdicts[2].within),
                       fmt::format("{:.2f} %", 100 * verdicts[3].within),
                       fmt::format("{:.2g} %", 100 * verdicts[0].worst_median),
                       fmt::format("{:.2g} %", 100 * verdicts[1].worst_median)});
            if (&m != &contestants.front()) m.outcome = {};
        }
    }
    fits.commit();
    times.commit();
    results.commit();
    log_info(table.text());
    experiment.draw(results, fmt::format("ornament, {} scale; {}{}", experiment.profile(), cpu, opengl));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("reflectance", argc, argv, radiafit::reflectance); }
