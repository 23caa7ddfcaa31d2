// The compute engine against its oracles: the naive one in double, and the CPU engine.
#include "compute/compute_engine.h"
#include "compute/compute_plan.h"
#include "context_kinds.h"
#include "failing_gl.h"
#include "lfm_agreement.h"
#include "samples/raster_distributor.h"

namespace radiafit {
using namespace harness;
namespace {

/// One of the engine's ways to samples and to sums.
struct Way {
    const char* name;
    bool streamed;
    Accumulate accumulate;
};
constexpr Way ways[] = {
    {"cached_gather", false, Accumulate::gather},        {"cached_fixed", false, Accumulate::scatter_fixed},
    {"cached_float", false, Accumulate::scatter_float},  {"cached_swap", false, Accumulate::scatter_swap},
    {"streamed_gather", true, Accumulate::gather},       {"streamed_fixed", true, Accumulate::scatter_fixed},
    {"streamed_float", true, Accumulate::scatter_float}, {"streamed_swap", true, Accumulate::scatter_swap}};
std::ostream& operator<<(std::ostream& out, const Way& way) { return out << way.name; }

class ComputeAgreement : public ::testing::TestWithParam<std::tuple<Case, Way>> {};

/// An engine whose samples are the list's; one that streams finds them anew.
auto engine_maker(const Way& way) {
    return [way](const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const SampleList& list,
                 const LfmOptions& options) {
        return way.streamed ? std::make_unique<ComputeEngine>(dataset, atlas, rings, list.views, options,
                                                              StreamOptions{}, way.accumulate)
                            : std::make_unique<ComputeEngine>(dataset, atlas, rings, list, options, way.accumulate);
    };
}
const auto make_engine = engine_maker(ways[0]);

TEST_P(ComputeAgreement, WithTheOracle) {
    const auto& [c, way] = GetParam();
    agree_with_the_oracle(c, engine_maker(way));
}
using ComputeIterations = ComputeAgreement;
TEST_P(ComputeIterations, WithTheCpuEngine) {
    const auto& [c, way] = GetParam();
    agree_with_the_cpu_engine_over_iterations(c, engine_maker(way));
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
std::string case_name(const ::testing::TestParamInfo<std::tuple<Case, Way>>& info) {
    return std::get<Case>(info.param).name + "_" + std::get<Way>(info.param).name;
}
/// Those that differ in more than a program's constants.
std::vector<Case> few_cases() {
    std::vector<Case> few;
    for (const Case& c : cases())
        if (c.name == "two_terms" || c.name == "odd_sides_16_bit" || c.name == "huber_facing") few.push_back(c);
    return few;
}
/// Every case with cached samples that are gathered, and with streamed ones in fixed point. The other two ways are made
/// of the same parts. Ways that add floats differ from fixed point in three macros of compute/accumulate.glsl alone;
/// the few cases use each of the sums that are added to.
std::vector<std::tuple<Case, Way>> cases_of_ways() {
    std::vector<std::tuple<Case, Way>> all;
    for (const Way& way : ways) {
        const bool floats = way.accumulate == Accumulate::scatter_float || way.accumulate == Accumulate::scatter_swap;
        const bool every = way.accumulate == (way.streamed ? Accumulate::scatter_fixed : Accumulate::gather);
        for (const Case& c : floats ? few_cases() : every ? cases() : structural_cases(cases()))
            all.emplace_back(c, way);
    }
    return all;
}
INSTANTIATE_TEST_SUITE_P(Cases, ComputeAgreement, ::testing::ValuesIn(cases_of_ways()), case_name);
INSTANTIATE_TEST_SUITE_P(Gathered, ComputeIterations,
                         ::testing::Combine(::testing::ValuesIn(structural_cases(cases())), ::testing::Values(ways[0])),
                         case_name);
INSTANTIATE_TEST_SUITE_P(Others, ComputeIterations,
                         ::testing::Combine(::testing::ValuesIn(few_cases()),
                                            ::testing::ValuesIn(ways + 1, std::end(ways))),
                         case_name);

/// Work groups of every size, with all that depends on it: sums in groups and rows of samples.
class GroupSize : public ::testing::TestWithParam<int> {
protected:
    void SetUp() override { ::setenv("RADIAFIT_GROUP_SIZE", std::to_string(GetParam()).c_str(), 1); }
    void TearDown() override { ::unsetenv("RADIAFIT_GROUP_SIZE"); }
};
TEST_P(GroupSize, AgreesWithTheOracle) {
    if (GetParam() == 8) return;  // as in all other tests
    for (const Way& way : {ways[0], ways[5]})
        for (const Case& c : cases())
            if (c.name == "two_terms" || c.name == "odd_sides_16_bit") agree_with_the_oracle(c, engine_maker(way));
}
INSTANTIATE_TEST_SUITE_P(Of, GroupSize, ::testing::Values(8, 32, 64, 128), ::testing::PrintToStringParamName());

TEST(GroupSizes, AreAskedForAndFitTheDevice) {
    const Context& context = SharedContext::use();
    const auto size = [&](const char* asked, size_t each) {
        ::setenv("RADIAFIT_GROUP_SIZE", asked, 1);
        const size_t found = context.group_size(64, each);
        ::unsetenv("RADIAFIT_GROUP_SIZE");
        return found;
    };
    EXPECT_EQ(size("128", 16), 128u);
    EXPECT_EQ(size("128", size_t(context.limits().shared_bytes) / 100), 64u);
    EXPECT_EQ(size("32", size_t(context.limits().shared_bytes) / 20), 8u);
    EXPECT_EQ(context.group_size(64, 16), context.software() ? 8u : 64u);
    EXPECT_THROW(size("16", 16), UserError);
    if (std::getenv("force_gl_renderer")) {
        EXPECT_FALSE(context.software()) << "the test played_chip plays none";
    }
    ::unsetenv("RADIAFIT_GROUP_SIZE");
}

/// A scene that engines share, of noise. Lists are made by OpenGL, so that engines that stream find the same samples.
struct ComputeScene {
    NoiseDataset noise{awkward_mesh(1)};
    const Dataset& dataset = noise.dataset;
    TriangleAtlas atlas{dataset.mesh, 8};
    VertexRings rings{dataset.mesh};

    SampleList list(const std::vector<uint32_t>& views = all_views()) const {
        GlDistributor distributor(atlas);
        return build_sample_list(dataset, atlas, views, {&distributor});
    }
    std::unique_ptr<ComputeEngine> engine(const Way& way, const SampleList& list,
                                          const LfmOptions& options = {}) const {
        return engine_maker(way)(dataset, atlas, rings, list, options);
    }
};

std::vector<float> run(ContextKind kind, const ComputeScene& scene, const Way& way, const SampleList& list) {
    const auto context = make_context(kind);
    const auto engine = scene.engine(way, list);
    engine->reset(lfm_start(engine->layout(), engine->count().mean, 3));
    const Trace trace = optimize(*engine, OptimizerOptions{.iterations = 3});
    std::vector<float> p(engine->layout().size());
    engine->read_parameters(p);
    p.push_back(float(trace.rows.back().error));
    return p;
}

class ComputeBits : public ::testing::TestWithParam<Way> {};
TEST_P(ComputeBits, AreTheSameTwiceAndInEveryContext) {
    const ComputeScene scene;
    const SampleList list = [&] {
        const auto context = make_context(ContextKind::egl);
        return scene.list();
    }();
    const std::vector<float> first = run(ContextKind::egl, scene, GetParam(), list);
    EXPECT_EQ(first, run(ContextKind::egl, scene, GetParam(), list));
    if (has_osmesa() && make_context(ContextKind::egl)->software()) {
        EXPECT_EQ(first, run(second_kind(), scene, GetParam(), list));
    }
}
std::string way_name(const ::testing::TestParamInfo<Way>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Ways, ComputeBits, ::testing::Values(ways[0], ways[1], ways[4], ways[5]), way_name);

/// Everything that sweeps over samples leave, at random parameters.
struct Sums {
    ProblemStatistics statistics;
    ComputeEngine::Evaluation evaluation;
    ComputeEngine::Line line;

    std::vector<float> gradient_and_diagonal() const {
        std::vector<float> all = evaluation.gradient;
        all.insert(all.end(), evaluation.diagonal.begin(), evaluation.diagonal.end());
        return all;
    }
};
Sums sums_of(ComputeEngine& engine, std::span<const float> p, std::span<const float> d) {
    Sums sums{engine.count(), {}, {}};
    engine.reset(p);
    engine.gradient_pass(true);
    sums.evaluation = engine.read_evaluation();
    engine.set_line(p, d);
    engine.directional_pass();
    sums.line = engine.read_line();
    return sums;
}

class FixedPoint : public ::testing::TestWithParam<Way> {};
/// Images the other way round, and samples of a group in any order.
TEST_P(FixedPoint, IsTheSameBitsInAnyOrder) {
    SharedContext::use();
    const ComputeScene scene;
    std::vector<uint32_t> backwards = all_views();
    std::ranges::reverse(backwards);
    SampleList list = scene.list(), other = scene.list(backwards);
    std::mt19937 rng(7);
    for (size_t g = 0; g + 1 < other.groups.size(); ++g)
        std::shuffle(other.samples.begin() + ptrdiff_t(other.groups[g].first),
                     other.samples.begin() + ptrdiff_t(other.groups[g + 1].first), rng);
    LfmOptions options;
    options.terms = 2;
    const auto engine = scene.engine(GetParam(), list, options), reordered = scene.engine(GetParam(), other, options);
    const std::vector<float> p = random_vector(engine->layout(), -0.5f, 1.5f, 1),
                             d = random_vector(engine->layout(), -1, 1, 2);
    const Sums a = sums_of(*engine, p, d), b = sums_of(*reordered, p, d);
    EXPECT_EQ(a.statistics.samples, b.statistics.samples);
    EXPECT_EQ(a.statistics.mean, b.statistics.mean);
    EXPECT_EQ(a.evaluation.error, b.evaluation.error);
    EXPECT_EQ(a.gradient_and_diagonal(), b.gradient_and_diagonal());
    EXPECT_EQ(a.line.curvature, b.line.curvature);
    EXPECT_EQ(a.line.fourth, b.line.fourth);
}

/// Constant maps make every term as large as its bound allows; and magnitudes far from 1.
TEST_P(FixedPoint, DoesNotOverflow) {
    SharedContext::use();
    const ComputeScene scene;
    const SampleList list = scene.list();
    LfmOptions options;
    options.terms = 2;
    options.lambda_surface = options.lambda_view = options.mu = 0;
    const auto fixed = scene.engine(GetParam(), list, options), gathered = scene.engine(ways[0], list, options);
    for (const float size : {1e-6f, 1.0f, 1e4f, 1e8f}) {
        const std::vector<float> p = random_vector(fixed->layout(), 0.999f * size, size, 1);
        const Sums a = sums_of(*fixed, p, p), b = sums_of(*gathered, p, p);
        const auto near = [&](const std::vector<float>& x, const std::vector<float>& y, const char* what) {
            for (size_t i = 0; i < x.size(); ++i)
                ASSERT_NEAR(x[i], y[i], 1e-5f * std::abs(y[i])) << what << " " << i << " of maps of " << size;
        };
        near(a.evaluation.error, b.evaluation.error, "error");
        near(a.line.gauss_newton, b.line.gauss_newton, "gauss-newton");
        near(a.line.fourth, b.line.fourth, "fourth");
        if (size > 1) near(a.gradient_and_diagonal(), b.gradient_and_diagonal(), "gradient");  // else terms cancel
    }
}

/// Where a term may be no float, no sum is taken for one.
TEST_P(FixedPoint, KnowsNoSumsOfWhatIsNotFinite) {
    SharedContext::use();
    const ComputeScene scene;
    const auto engine = scene.engine(GetParam(), scene.list());
    const ProblemStatistics statistics = engine->count();
    for (const float huge : {1e15f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
        engine->reset(std::vector<float>(engine->layout().size(), huge));
        engine->gradient_pass(false);
        const std::vector<float> error = engine->read_evaluation().error;
        for (size_t i = 0; i < error.size(); ++i)
            if (statistics.samples[i / 3]) {
                EXPECT_FALSE(std::isfinite(error[i])) << i << " of maps of " << huge;
            }
    }
}
INSTANTIATE_TEST_SUITE_P(Ways, FixedPoint, ::testing::Values(ways[1], ways[5]), way_name);

class FloatScatter : public ::testing::TestWithParam<Way> {};
/// Repeated sums differ, by rounding alone: told, and at most a tenth of what tests allow of any engine.
TEST_P(FloatScatter, SpreadsLittle) {
    SharedContext::use();
    const ComputeScene scene;
    const SampleList list = scene.list();
    const LfmOptions options{.lambda_surface = 0, .lambda_view = 0, .mu = 0};
    const auto engine = scene.engine(GetParam(), list, options);
    const LfmLayout& layout = engine->layout();
    const std::vector<float> p = random_vector(layout, -0.5f, 1.5f, 1), d = random_vector(layout, -1, 1, 2);
    const auto oracle =
        lfm_oracle(scene.dataset, scene.atlas, scene.rings, layout, options, list, {p.begin(), p.end()}, {});
    std::vector<float> low, high;
    for (int turn = 0; turn < 8; ++turn) {
        const std::vector<float> gradient = sums_of(*engine, p, d).evaluation.gradient;
        if (turn == 0) low = high = gradient;
        for (size_t i = 0; i < gradient.size(); ++i)
            low[i] = std::min(low[i], gradient[i]), high[i] = std::max(high[i], gradient[i]);
    }
    double widest = 0;
    for (size_t v = 0; v < layout.problem_count(); ++v)
        for (size_t i = layout.offset(v); i < layout.offset(v + 1); ++i) {
            if (oracle.gradient[i].magnitude == 0) continue;
            const double scale = double(layout.surface_texels(v)) / oracle.samples[v] * oracle.gradient[i].magnitude;
            widest = std::max(widest, double(high[i] - low[i]) / scale);
        }
    std::printf("  %s: widest spread of a gradient's entry over 8 sums, of its terms' magnitudes: %.1e\n",
                describe(engine->accumulate()), widest);
    EXPECT_LE(widest, 1e-6);
}
INSTANTIATE_TEST_SUITE_P(Ways, FloatScatter, ::testing::Values(ways[2], ways[3], ways[6], ways[7]), way_name);

/// Whatever sums come about by, fits end alike.
TEST(Compute, FitsEndAlikeInEveryWay) {
    SharedContext::use();
    const ComputeScene scene;
    const SampleList list = scene.list();
    std::vector<double> errors;
    for (const Way& way : ways) {
        const auto engine = scene.engine(way, list);
        engine->reset(lfm_start(engine->layout(), engine->count().mean, 3));
        const Trace trace = optimize(*engine, OptimizerOptions{.iterations = 6});
        errors.push_back(trace.rows.back().error);
        EXPECT_LT(errors.back(), 0.5 * trace.rows.front().error) << way;
        EXPECT_NEAR(errors.back(), errors.front(), 1e-3 * errors.front())  // rounding grows over conjugate steps
            << way;
    }
}

TEST(Compute, EveryAllocationThatFailsIsTold) {
    SharedContext::use();
    const ComputeScene scene;
    const SampleList list = scene.list();
    for (const Way& way : {ways[0], ways[5]})
        EXPECT_GT(fail_each_allocation([&] {
                      const auto engine = scene.engine(way, list);
                      engine->reset(lfm_start(engine->layout(), engine->count().mean, 3));
                      optimize(*engine, {.iterations = 1});
                  }),
                  20)
            << way;
}

/// What is planned is no less than what the device holds, and not much more; the host's part is in the plan, too.
TEST(Compute, TakesWhatIsPlanned) {
    SharedContext::use();
    const ComputeScene scene;
    const SampleList list = scene.list();
    for (const int terms : {1, 3})
        for (const Way& way : ways) {
            LfmOptions options;
            options.terms = terms;
            const auto engine = scene.engine(way, list, options);
            const LfmLayout& layout = engine->layout();
            const auto arrays = way.streamed ? plan_redistribution(scene.dataset, scene.atlas, scene.rings, layout,
                                                                   way.accumulate, list.views, StreamOptions{})
                                             : plan_cached_samples(scene.atlas, scene.rings, layout, way.accumulate,
                                                                   list.image_count(), list.samples.size(), 4);
            uint64_t planned = 0;
            for (const PlannedArray& array : arrays) planned += array.bytes;
            const uint64_t numbers = engine->problem_count() * 100;  // of problems, which no plan tells
            const uint64_t held = engine->bytes() - vector::first_own * layout.size() * sizeof(float);
            EXPECT_GE(planned + numbers, held) << way << ", " << terms << " terms";
            EXPECT_LT(double(planned), 1.7 * double(held)) << way << ", " << terms << " terms";
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

/// Of two ways that promise it and have all passes between them, with work groups of every size.
TEST_P(GroupSize, GivesTheSameBitsTwice) {
    SharedContext::use();
    const ComputeScene scene;
    const SampleList list = scene.list();
    const LfmOptions options;
    for (const Way& way : {ways[0], ways[5]}) {
        const auto parameters = [&] {
            const auto engine = scene.engine(way, list, options);
            EXPECT_EQ(engine->group_size(), size_t(GetParam()));
            return fitted(*engine, engine->layout(), {.iterations = 2}, 1, false).parameters;
        };
        EXPECT_EQ(parameters(), parameters()) << way;
    }
}

/// Problems that end while others of their vertex and triangle run on; and terms one after another.
TEST(Compute, EndsProblemsOneByOne) {
    SharedContext::use();
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
    SharedContext::use();
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
