// Makes the synthetic star, fits a light field map by conjugate gradients, and judges it on views that it has not seen.
#include <fmt/format.h>
#include <radiafit/cpu/lfm_engine.h>
#include <radiafit/eval/judge.h>
#include <radiafit/model/lfm_start.h>
#include <radiafit/optim/optimizer.h>
#include <radiafit/samples/raster_distributor.h>
#include <radiafit/synthetic/synthetic.h>

using namespace radiafit;

int main() {
    generate_synthetic({.shape = "star", .scale = "smoke"}, "star");
    const Dataset dataset = open_dataset("star");
    const LfmOptions options{.terms = 2, .surface_side = 8, .view_side = 8};
    const TriangleAtlas atlas(dataset.mesh, options.surface_side);
    const VertexRings rings(dataset.mesh);
    const auto distributors = raster_distributors(atlas);  // which pixel of an image each texel takes
    const SampleList samples = build_sample_list(dataset, atlas, dataset.split(false), worker_pointers(distributors));

    LfmProblem<float> problem(dataset, atlas, rings, samples, options);
    StreamEngine<float> engine(problem);
    const ProblemStatistics statistics = engine.count();
    LightFieldFit fit;
    fit.options = options;
    fit.parameters = lfm_start(problem.layout(), statistics.mean, 1);
    const Trace trace = optimize_terms(engine, {.rule = Rule::cg_modern}, options.terms, false, fit.parameters);
    std::vector<ProblemOutcome> outcomes(engine.problem_count());
    engine.outcomes(outcomes);
    for (size_t i = 0; i < outcomes.size(); ++i) {
        fit.status.push_back(outcomes[i].status);
        fit.samples.push_back(statistics.samples[i / 3]);  // three channels of a vertex
    }
    const JudgeResult judged = judge(contestant_of(fit, dataset.mesh), dataset, Split::test);
    fmt::print("error {:.4g} -> {:.4g}; held out: PSNR {:.2f} dB\n", trace.rows.front().error, trace.rows.back().error,
               judged.psnr());
}
