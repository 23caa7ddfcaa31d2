// The compute engine against its oracles: the naive one in double, and the CPU engine.
#include "compute/compute_engine.h"
#include "lfm_agreement.h"
#include "samples/raster_distributor.h"

namespace radiafit {
namespace {

class ComputeAgreement : public ::testing::TestWithParam<Case> {};

const auto make_engine = [](const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                            const SampleList& list, const LfmOptions& options) {
    return std::make_unique<ComputeEngine>(dataset, atlas, rings, list, options);
};

TEST_P(ComputeAgreement, WithTheOracle) { agree_with_the_oracle(GetParam(), make_engine); }
TEST_P(ComputeAgreement, WithTheCpuEngineOverIterations) {
    agree_with_the_cpu_engine_over_iterations(GetParam(), make_engine);
}

std::vector<Case> cases() {
    return {{.name = "plain", .levels = 2},
            {.name = "two_terms", .terms = 2},
            {.name = "nearest", .lookup = ViewLookup::nearest},
            {.name = "odd_sides_16_bit", .surface_side = 7, .view_side = 5, .encoding = Encoding::u16_linear},
            {.name = "large_sides", .surface_side = 22, .view_side = 17, .levels = 0},
            {.name = "tiles_of_more_texels_than_a_byte_counts", .surface_side = 24, .levels = 0},
            {.name = "huber", .terms = 2, .loss = {LossKind::huber, 0.4f}},
            {.name = "cauchy", .loss = {LossKind::cauchy, 0.4f}},
            {.name = "facing", .loss = {.weights = SampleWeights::facing}},
            {.name = "huber_facing",
             .terms = 2,
             .lookup = ViewLookup::nearest,
             .loss = {LossKind::huber, 0.4f, SampleWeights::facing}},
            {.name = "small_sides_many_terms", .terms = 9, .surface_side = 2, .view_side = 2}};
}
INSTANTIATE_TEST_SUITE_P(Cases, ComputeAgreement, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

std::vector<float> run(ContextKind kind, const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& list) {
    const auto context = make_context(kind);
    const VertexRings rings(dataset.mesh);
    ComputeEngine engine(dataset, atlas, rings, list, {});
    engine.reset(lfm_start(engine.layout(), engine.count().mean, 3));
    const Trace trace = optimize(engine, OptimizerOptions{.iterations = 3});
    std::vector<float> p(engine.layout().size());
    engine.read_parameters(p);
    p.push_back(float(trace.rows.back().error));
    return p;
}

TEST(Compute, SameBitsTwiceAndInEveryContext) {
    const NoiseDataset noise(awkward_mesh(1));
    const TriangleAtlas atlas(noise.dataset.mesh, 8);
    RasterDistributor distributor(atlas);
    const SampleList list = build_sample_list(noise.dataset, atlas, all_views(), {&distributor});
    const std::vector<float> first = run(ContextKind::egl, noise.dataset, atlas, list);
    EXPECT_EQ(first, run(ContextKind::egl, noise.dataset, atlas, list));
    if (make_context(ContextKind::egl)->software()) {
        EXPECT_EQ(first, run(ContextKind::osmesa, noise.dataset, atlas, list));
    }
}

struct Fitted {
    Trace trace;
    std::vector<float> parameters;
    std::vector<ProblemOutcome> outcomes;
};
template <Engine E>
Fitted fitted(E& engine, const LfmLayout& layout, const OptimizerOptions& optimizer, int terms, bool deflate) {
    Fitted out;
    const ProblemStatistics statistics = engine.count();
    out.parameters = lfm_start(layout, statistics.mean, 3);
    engine.make_room({.vectors = 2, .numbers = 3, .products = 2});  // as if another optimizer had been here
    out.trace = optimize_terms(engine, optimizer, terms, deflate, out.parameters);
    out.outcomes.resize(engine.problem_count());
    engine.outcomes(out.outcomes);
    return out;
}

/// Problems that end while others of their vertex and triangle run on; and terms one after another.
TEST(Compute, EndsProblemsOneByOne) {
    const auto context = make_context(ContextKind::egl);
    const NoiseDataset noise(awkward_mesh(1));
    const TriangleAtlas atlas(noise.dataset.mesh, 8);
    const VertexRings rings(noise.dataset.mesh);
    RasterDistributor distributor(atlas);
    const SampleList list = build_sample_list(noise.dataset, atlas, all_views(), {&distributor});
    LfmOptions options;
    options.terms = 2;
    for (const bool deflate : {false, true}) {
        const OptimizerOptions optimizer{.iterations = 12, .stop_output_change = deflate ? 0.0f : 0.02f};
        ComputeEngine engine(noise.dataset, atlas, rings, list, options);
        LfmProblem<float> problem(noise.dataset, atlas, rings, list, options);
        StreamEngine<float> cpu(problem);
        const Fitted a = fitted(engine, engine.layout(), optimizer, 2, deflate),
                     b = fitted(cpu, problem.layout(), optimizer, 2, deflate);
        ASSERT_EQ(a.trace.rows.size(), b.trace.rows.size());
        for (size_t i = 0; i < b.trace.rows.size(); ++i) {
            EXPECT_NEAR(a.trace.rows[i].error, b.trace.rows[i].error, 1e-3 * b.trace.rows[i].error) << i;
            EXPECT_NEAR(double(a.trace.rows[i].active), double(b.trace.rows[i].active),
                        0.02 * double(engine.problem_count()))
                << i;
        }
        if (deflate) continue;
        size_t mixed = 0;  // vertices whose problems did not all end together
        for (size_t v = 0; v < rings.vertex_count(); ++v) {
            const auto iterations = [&](size_t c) { return a.outcomes[3 * v + c].iterations; };
            mixed += iterations(0) != iterations(1) || iterations(1) != iterations(2);
        }
        EXPECT_GT(mixed, 10U);
    }
}

/// Sides of each triangle's own, which the fragment engine has not.
TEST(Compute, TakesTrianglesOfSeveralSides) {
    const auto context = make_context(ContextKind::egl);
    const NoiseDataset noise(awkward_mesh(1));
    std::vector<uint8_t> sides(noise.dataset.mesh.triangle_count());
    for (size_t i = 0; i < sides.size(); ++i) sides[i] = uint8_t(3 + i % 6);
    const TriangleAtlas atlas(noise.dataset.mesh, 8, std::make_shared<const std::vector<uint8_t>>(sides));
    const VertexRings rings(noise.dataset.mesh);
    RasterDistributor distributor(atlas);
    const SampleList list = build_sample_list(noise.dataset, atlas, all_views(), {&distributor});
    LfmOptions options;
    options.terms = 2;
    ComputeEngine engine(noise.dataset, atlas, rings, list, options);
    LfmProblem<double> problem(noise.dataset, atlas, rings, list, options);
    StreamEngine<double> oracle(problem);
    const ProblemStatistics statistics = oracle.count();
    EXPECT_EQ(engine.count().samples, statistics.samples);
    const std::vector<float> start = lfm_start(engine.layout(), statistics.mean, 3);
    engine.reset(start);
    oracle.reset(start);
    const OptimizerOptions optimizer{.iterations = 5};
    const Trace a = optimize(engine, optimizer), b = optimize(oracle, optimizer);
    for (size_t i = 0; i < b.rows.size(); ++i) EXPECT_NEAR(a.rows[i].error, b.rows[i].error, 2e-5 * b.rows[i].error);
}

}  // namespace
}  // namespace radiafit
