// A reflectance model of one's own, own_model.glsl, fitted to every texel of the synthetic ornament.
#include <fmt/format.h>
#include <radiafit/cpu/texel_solvers_of.h>
#include <radiafit/eval/judge.h>
#include <radiafit/model/texel_model_of.h>
#include <radiafit/samples/raster_distributor.h>
#include <radiafit/synthetic/synthetic.h>

#define RADIAFIT_TEXEL_MODEL blinn_phong
#define RADIAFIT_TEXEL_FILE "own_model.glsl"
#include <radiafit/model/define_texel_text.h>

using namespace radiafit;

int main() {
    generate_synthetic({.shape = "ornament", .scale = "smoke"}, "ornament");
    const Dataset dataset = open_dataset("ornament");
    const TexelModelOf<texel_text::blinn_phong<float>> model;
    const TexelSolversOf<texel_text::blinn_phong<Pack>> solvers;

    ReflectanceFit fit;
    fit.options.model = &model;
    fit.options.surface_side = dataset.normal_map.side;
    const TriangleAtlas atlas(dataset.mesh, fit.options.surface_side);
    const std::vector<uint32_t> views = dataset.split(false);
    const auto distributors = raster_distributors(atlas);
    const auto samples = gather_texels(dataset, atlas, views, worker_pointers(distributors));
    const TexelLoader loader(dataset, atlas, views, fit.options);
    const TexelResult result = solvers.solve_lm({*samples, loader, fit.options}, {.iterations = 50}, {});

    fit.parameters = result.parameters;
    fit.status = result.status;
    fit.samples = result.samples;
    const JudgeResult judged = judge(contestant_of(fit, atlas), dataset, Split::test);
    fmt::print("{} texels; held out: PSNR {:.2f} dB\n", fit.problem_count(), judged.psnr());
}
